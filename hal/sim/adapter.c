/* SPDX-License-Identifier: MIT */
/*
 * The simulated network as an I2C adapter. A byte takes effect at the time of its acknowledge bit,
 * which the adapter computes from the bus's speed; the caller waits once, at the end of a
 * transaction, until the time has come.
 */
#include <errno.h>

#include "hal/base/time.h"
#include "hal/sim/adapter.h"

/* The bits of a transaction: a START or STOP condition takes about one, a byte nine. */
#define BITS_BYTE 9

struct clock {
	struct sim_adapter *adapter;
	int64_t now;
};

static int64_t bits_ns(const struct sim_adapter *adapter, unsigned n)
{
	return NS_PER_S * n / adapter->net->hz;
}

static void adapter_begin(struct clock *clock, struct sim_adapter *adapter)
{
	int64_t now = adapter->env->now(adapter->env->ctx);

	clock->adapter = adapter;
	clock->now = now < adapter->free_at ? adapter->free_at : now;
}

static int transact_message(struct clock *clock, uint8_t address, const struct i2c_message *message)
{
	struct sim_adapter *adapter = clock->adapter;
	struct sim_net *net = adapter->net;
	bool read = message->flags & I2C_MESSAGE_READ;

	clock->now += bits_ns(adapter, 1 + BITS_BYTE);
	adapter->adapter.bytes++;
	if (!sim_i2c_start(net, address, read, clock->now))
		return net->plugged ? -ENXIO : -ENODEV;
	for (unsigned i = 0; i < message->len; i++) {
		if (read)
			message->data[i] = sim_i2c_read(net, clock->now);
		clock->now += bits_ns(adapter, BITS_BYTE);
		adapter->adapter.bytes++;
		if (!read && !sim_i2c_write(net, message->data[i], clock->now))
			return net->plugged ? -EIO : -ENODEV;
	}
	return net->plugged ? 0 : -ENODEV;
}

/* Send the STOP, and wait until the transaction's time is over. */
static int adapter_end(struct clock *clock, int err)
{
	struct sim_adapter *adapter = clock->adapter;
	int waited;

	clock->now += bits_ns(adapter, 1);
	adapter->free_at = clock->now;
	adapter->adapter.transfers++;
	adapter->adapter.syscalls++;
	waited = adapter->env->wait(adapter->env->ctx, -1, 0, clock->now);
	return waited == -ECANCELED ? waited : err;
}

static bool is_allowed(const struct i2c_adapter *adapter, const struct i2c_message *messages,
                       size_t n)
{
	switch (adapter->combine) {
	case I2C_SMBUS_ONLY:
		return false;
	case I2C_ONE_READ_LAST:
		for (size_t i = 0; i + 1 < n; i++) {
			if (messages[i].flags & I2C_MESSAGE_READ)
				return false;
		}
		break;
	case I2C_ANY:
		break;
	}
	return n > 0 && n <= adapter->max_messages;
}

static int transact(struct i2c_adapter *base, uint8_t address, struct i2c_message *messages,
                    size_t n)
{
	struct sim_adapter *adapter = (struct sim_adapter *)base;
	struct clock clock;
	int err = 0;

	adapter_begin(&clock, adapter);
	for (size_t i = 0; !err && i < n; i++)
		err = transact_message(&clock, address, &messages[i]);
	return adapter_end(&clock, err);
}

static int sim_transfer(struct i2c_adapter *base, uint8_t address, struct i2c_message *messages,
                        size_t n)
{
	return is_allowed(base, messages, n) ? transact(base, address, messages, n) : -EOPNOTSUPP;
}

static int sim_write_byte(struct i2c_adapter *base, uint8_t address, uint8_t command)
{
	struct i2c_message message = {.len = 1, .data = &command};

	return transact(base, address, &message, 1);
}

static int write_byte_data(struct i2c_adapter *base, uint8_t address, uint8_t command, uint8_t data)
{
	uint8_t bytes[2] = {command, data};
	struct i2c_message message = {.len = 2, .data = bytes};

	return transact(base, address, &message, 1);
}

static int sim_read_byte(struct i2c_adapter *base, uint8_t address)
{
	uint8_t byte = 0xFF;
	struct i2c_message message = {.flags = I2C_MESSAGE_READ, .len = 1, .data = &byte};
	int err = transact(base, address, &message, 1);

	return err ? err : byte;
}

static int sim_claim(struct i2c_adapter *base, uint8_t address)
{
	struct sim_adapter *adapter = (struct sim_adapter *)base;

	(void)address;
	sim_net_run(adapter->net, adapter->env->now(adapter->env->ctx));
	return adapter->net->plugged ? 0 : -ENODEV;
}

static void adapter_close(struct i2c_adapter *base)
{
	((struct sim_adapter *)base)->open = false;
}

static const struct i2c_adapter_ops sim_adapter_ops = {
	.transfer = sim_transfer,
	.write_byte = sim_write_byte,
	.write_byte_data = write_byte_data,
	.read_byte = sim_read_byte,
	.claim = sim_claim,
	.close = adapter_close,
};

void sim_adapter_init(struct sim_adapter *adapter, struct sim_net *net, const struct bus_env *env)
{
	static const enum i2c_combine combine[] = {
		[SIM_SMBUS_ONLY] = I2C_SMBUS_ONLY,
		[SIM_ONE_READ_LAST] = I2C_ONE_READ_LAST,
		[SIM_ANY_MESSAGES] = I2C_ANY,
	};

	*adapter = (struct sim_adapter){
		.adapter =
			{
				.ops = &sim_adapter_ops,
				.combine = combine[net->combine],
				.max_messages = net->max_messages,
			},
		.net = net,
		.env = env,
		.open = true,
	};
}
