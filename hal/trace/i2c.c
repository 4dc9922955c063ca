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
	struct lines *lines;
	const struct bus_env *env;
};

#define CAN_MOST (I2C_ANY | 0xff << 2)
#define READ_MOST 4096

#define TOLD(adapter) ((struct trace_adapter *)(adapter))
/* Of a recording: what the adapter below answers to the question. */
#define UNDER(adapter, call, ...) \
	(TOLD(adapter)->under ? TOLD(adapter)->under->ops->call(TOLD(adapter)->under, __VA_ARGS__) \
	                      : 0)

static FILE *ask(struct i2c_adapter *adapter)
{
	return trace_ask(TOLD(adapter)->lines, TOLD(adapter)->env, &TOLD(adapter)->lines->i2c);
}

/* What was never asked is refused by the bus. */
static int answer(struct i2c_adapter *adapter, int most, int result, uint8_t *bytes, size_t n)
{
	size_t got = TOLD(adapter)->under && result < 0 ? 0 : n;

	result = trace_told(TOLD(adapter)->lines, most, result, bytes, &got);
	/* How often a status is read is a matter of time */
	if (got && got < n)
		memset(bytes + got, bytes[got - 1], n - got);
	return result == -EHOSTDOWN ? -ENXIO : result;
}

/* What the messages read is one answer. The last count is left out, as it depends on time. */
static int told_transfer(struct i2c_adapter *adapter, uint8_t address, struct i2c_message *messages,
                         size_t n)
{
	FILE *now = ask(adapter);
	uint8_t all[READ_MOST];
	size_t len = 0, last = n - 1;
	int result;

	fprintf(now, "transfer %02X", address);
	for (size_t i = 0; i < n; i++) {
		bool reads = messages[i].flags & I2C_MESSAGE_READ;

		fputs(reads ? " r" : " w ", now);
		if (!reads)
			trace_bytes(now, messages[i].data, messages[i].len, TRACE_HEX);
		else if (i < last)
			fprintf(now, " %u", messages[i].len);
		len += reads ? messages[i].len : 0;
	}
	if (len > sizeof(all))
		return -EOPNOTSUPP;
	result = UNDER(adapter, transfer, address, messages, n);
	for (size_t at = 0, i = 0; i < n; i++)
		if (messages[i].flags & I2C_MESSAGE_READ) {
			memcpy(all + at, messages[i].data, messages[i].len);
			at += messages[i].len;
		}
	result = answer(adapter, 0, result, all, len);
	for (size_t at = 0, i = 0; i < n; i++)
		if (messages[i].flags & I2C_MESSAGE_READ) {
			memcpy(messages[i].data, all + at, messages[i].len);
			at += messages[i].len;
		}
	return result;
}

static int told_write_byte(struct i2c_adapter *adapter, uint8_t address, uint8_t command)
{
	fprintf(ask(adapter), "write %02X %02X", address, command);
	return answer(adapter, 0, UNDER(adapter, write_byte, address, command), NULL, 0);
}

static int told_write_byte_data(struct i2c_adapter *adapter, uint8_t address, uint8_t command,
                                uint8_t data)
{
	fprintf(ask(adapter), "write %02X %02X%02X", address, command, data);
	return answer(adapter, 0, UNDER(adapter, write_byte_data, address, command, data), NULL, 0);
}

static int told_read_byte(struct i2c_adapter *adapter, uint8_t address)
{
	fprintf(ask(adapter), "read %02X", address);
	return answer(adapter, UINT8_MAX, UNDER(adapter, read_byte, address), NULL, 0);
}

static int told_claim(struct i2c_adapter *adapter, uint8_t address)
{
	struct i2c_adapter *under = TOLD(adapter)->under;
	int err;

	fprintf(ask(adapter), "claim %02X", address);
	err = answer(adapter, 0, UNDER(adapter, claim, address), NULL, 0);
	adapter->holder = under ? under->holder : 0;
	return err;
}

static void told_release(struct i2c_adapter *adapter, uint8_t address)
{
	struct i2c_adapter *under = TOLD(adapter)->under;

	if (under && under->ops->release)
		under->ops->release(under, address);
}

static void told_close(struct i2c_adapter *adapter)
{
	if (TOLD(adapter)->under)
		TOLD(adapter)->under->ops->close(TOLD(adapter)->under);
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
		.adapter.ops = &told_ops, .under = under, .lines = (struct lines *)tap, .env = env};
	can = under ? (int)(under->combine | under->max_messages << 2) : 0;
	fputs("adapter", ask(&told->adapter));
	can = answer(&told->adapter, CAN_MOST, can, NULL, 0);
	if (can >= 0) {
		told->adapter.combine = can & 3;
		told->adapter.max_messages = (unsigned)can >> 2;
	}
	return &told->adapter;
}
