/* SPDX-License-Identifier: MIT */
/*
 * An I2C adapter in front of another, which records its transactions, and one in place of it. An
 * id goes over I2C byte by byte, and in a search bit by bit: such a recording is not anonymous.
 */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "hal/ds2482/i2c.h"
#include "hal/trace/i2c.h"

struct trace_adapter {
	struct i2c_adapter adapter; /* first */
	struct i2c_adapter *under;  /* NULL: it is replayed */
	struct trace *trace;
	const struct bus_env *env;
};

#define CAN_MOST (I2C_ANY | 0xff << 2)

#define TOLD(adapter) ((struct trace_adapter *)(adapter))
#define ASK(adapter, ...) \
	trace_ask(TOLD(adapter)->trace, TOLD(adapter)->env, TRACE_I2C, __VA_ARGS__)
/* Of a recording: what the adapter below answers to the question. */
#define UNDER(adapter, call, ...) \
	(TOLD(adapter)->under ? TOLD(adapter)->under->ops->call(TOLD(adapter)->under, __VA_ARGS__) \
	                      : 0)

/* What was never asked is refused by the bus. */
static int answer(struct i2c_adapter *adapter, int most, int result, uint8_t *bytes, size_t n)
{
	struct i2c_adapter *under = TOLD(adapter)->under;
	size_t got = under && result < 0 ? 0 : n;

	result = trace_told(TOLD(adapter)->trace, most, result, bytes, &got);
	if (!under && got && got < n)
		memset(bytes + got, bytes[got - 1], n - got);
	if (under) {
		adapter->transfers = under->transfers;
		adapter->bytes = under->bytes;
		adapter->syscalls = under->syscalls;
		adapter->holder = under->holder;
	}
	return result == -EHOSTDOWN ? -ENXIO : result;
}

/* Several messages that read are one answer: all, of what the messages have, or they get it. */
static void copy_read(struct i2c_message *messages, size_t n, uint8_t *all, bool get)
{
	for (struct i2c_message *m = messages; m < messages + n; m++) {
		if (!(m->flags & I2C_MESSAGE_READ))
			continue;
		memcpy(get ? m->data : all, get ? all : m->data, m->len);
		all += m->len;
	}
}

static int told_transfer(struct i2c_adapter *adapter, uint8_t address, struct i2c_message *messages,
                         size_t n)
{
	struct trace_text *question = &TOLD(adapter)->trace->question;
	uint8_t all[4096];
	size_t len = 0;
	int result;

	ASK(adapter, "transfer %02X", address);
	for (size_t i = 0; i < n; i++)
		if (messages[i].flags & I2C_MESSAGE_READ) {
			trace_add(question, " r %u", messages[i].len);
			len += messages[i].len;
		} else {
			trace_add(question, " w ");
			trace_bytes(question, messages[i].data, messages[i].len, false);
		}
	if (len > sizeof(all))
		return -EOPNOTSUPP;
	result = UNDER(adapter, transfer, address, messages, n);
	if (TOLD(adapter)->under)
		copy_read(messages, n, all, false);
	result = answer(adapter, 0, result, all, len);
	copy_read(messages, n, all, true);
	return result;
}

static int told_write_byte(struct i2c_adapter *adapter, uint8_t address, uint8_t command)
{
	ASK(adapter, "write %02X %02X", address, command);
	return answer(adapter, 0, UNDER(adapter, write_byte, address, command), NULL, 0);
}

static int told_write_byte_data(struct i2c_adapter *adapter, uint8_t address, uint8_t command,
                                uint8_t data)
{
	ASK(adapter, "write %02X %02X%02X", address, command, data);
	return answer(adapter, 0, UNDER(adapter, write_byte_data, address, command, data), NULL, 0);
}

static int told_read_byte(struct i2c_adapter *adapter, uint8_t address)
{
	ASK(adapter, "read %02X", address);
	return answer(adapter, UINT8_MAX, UNDER(adapter, read_byte, address), NULL, 0);
}

static int told_claim(struct i2c_adapter *adapter, uint8_t address)
{
	ASK(adapter, "claim %02X", address);
	return answer(adapter, 0, UNDER(adapter, claim, address), NULL, 0);
}

static void told_release(struct i2c_adapter *adapter, uint8_t address)
{
	struct i2c_adapter *under = TOLD(adapter)->under;

	if (under && under->ops->release)
		under->ops->release(under, address);
}

static void told_close(struct i2c_adapter *adapter)
{
	struct i2c_adapter *under = TOLD(adapter)->under;

	if (under)
		under->ops->close(under);
	free(adapter);
}

static const struct i2c_adapter_ops told_ops = {
	.transfer = told_transfer,
	.write_byte = told_write_byte,
	.write_byte_data = told_write_byte_data,
	.read_byte = told_read_byte,
	.claim = told_claim,
	.release = told_release,
	.close = told_close,
};

/* What the adapter can combine is the first line. */
struct i2c_adapter *trace_adapter_of(struct tap *tap, const struct bus_env *env,
                                     struct i2c_adapter *under)
{
	struct trace_adapter *told = calloc(1, sizeof(*told));
	int can;

	if (!told)
		return under;
	*told = (struct trace_adapter){
		.adapter.ops = &told_ops, .under = under, .trace = (struct trace *)tap, .env = env};
	can = under ? (int)(under->combine | under->max_messages << 2) : 0;
	ASK(&told->adapter, "adapter");
	can = answer(&told->adapter, CAN_MOST, can, NULL, 0);
	if (can >= 0) {
		told->adapter.combine = can & 3;
		told->adapter.max_messages = (unsigned)can >> 2;
	}
	return &told->adapter;
}
