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

#define UNDER(told, call, ...) \
	((told)->under ? (told)->under->ops->call((told)->under, __VA_ARGS__) : 0)

static struct trace_adapter *ask(struct i2c_adapter *adapter, const char *what, uint8_t address)
{
	struct trace_adapter *told = (struct trace_adapter *)adapter;

	trace_ask(told->trace, told->env, "%s %02X", what, address);
	return told;
}

/* What was never asked is refused by the bus. */
static int answer(struct trace_adapter *told, int result, uint8_t *bytes, size_t n)
{
	struct i2c_adapter *under = told->under;
	size_t got = under && result < 0 ? 0 : n;

	result = trace_told(told->trace, told->env, &told->trace->i2c, result, bytes, &got);
	if (!under && got && got < n)
		memset(bytes + got, bytes[got - 1], n - got);
	if (under) {
		told->adapter.transfers = under->transfers;
		told->adapter.bytes = under->bytes;
		told->adapter.syscalls = under->syscalls;
		told->adapter.holder = under->holder;
	}
	return result == -EHOSTDOWN ? -ENXIO : result;
}

/* Several messages that read are one answer. */
static int told_transfer(struct i2c_adapter *adapter, uint8_t address, struct i2c_message *messages,
                         size_t n)
{
	struct trace_adapter *told = ask(adapter, "transfer", address);
	struct trace_text *question = &told->trace->question;
	uint8_t all[4096];
	size_t len = 0, at = 0;

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
	int result = UNDER(told, transfer, address, messages, n);
	for (size_t i = 0; told->under && i < n; i++)
		if (messages[i].flags & I2C_MESSAGE_READ) {
			memcpy(all + at, messages[i].data, messages[i].len);
			at += messages[i].len;
		}
	result = answer(told, result, all, len);
	for (size_t i = 0; !told->under && i < n; i++)
		if (messages[i].flags & I2C_MESSAGE_READ) {
			memcpy(messages[i].data, all + at, messages[i].len);
			at += messages[i].len;
		}
	return result;
}

static int told_write_byte(struct i2c_adapter *adapter, uint8_t address, uint8_t command)
{
	struct trace_adapter *told = ask(adapter, "write", address);

	trace_add(&told->trace->question, " %02X", command);
	return answer(told, UNDER(told, write_byte, address, command), NULL, 0);
}

static int told_write_byte_data(struct i2c_adapter *adapter, uint8_t address, uint8_t command,
                                uint8_t data)
{
	struct trace_adapter *told = ask(adapter, "write", address);

	trace_add(&told->trace->question, " %02X%02X", command, data);
	return answer(told, UNDER(told, write_byte_data, address, command, data), NULL, 0);
}

static int told_read_byte(struct i2c_adapter *adapter, uint8_t address)
{
	struct trace_adapter *told = ask(adapter, "read", address);

	return answer(told, told->under ? told->under->ops->read_byte(told->under, address) : 0,
	              NULL, 0);
}

static int told_claim(struct i2c_adapter *adapter, uint8_t address)
{
	struct trace_adapter *told = ask(adapter, "claim", address);

	return answer(told, told->under ? told->under->ops->claim(told->under, address) : 0, NULL,
	              0);
}

static void told_release(struct i2c_adapter *adapter, uint8_t address)
{
	struct i2c_adapter *under = ((struct trace_adapter *)adapter)->under;

	if (under && under->ops->release)
		under->ops->release(under, address);
}

static void told_close(struct i2c_adapter *adapter)
{
	struct i2c_adapter *under = ((struct trace_adapter *)adapter)->under;

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
	struct trace *trace = (struct trace *)tap;
	struct trace_adapter *told = calloc(1, sizeof(*told));
	int can;

	if (!told)
		return under;
	*told = (struct trace_adapter){
		.adapter.ops = &told_ops, .under = under, .trace = trace, .env = env};
	trace_ask(trace, env, "adapter");
	can = answer(told, under ? (int)(under->combine | under->max_messages << 2) : 0, NULL, 0);
	told->adapter.combine = can & 3;
	told->adapter.max_messages = (unsigned)can >> 2;
	return &told->adapter;
}
