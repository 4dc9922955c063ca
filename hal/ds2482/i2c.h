/* SPDX-License-Identifier: MIT */
/*
 * The I2C calls below the DS2482 driver: an adapter as i2c-dev offers it. hal/ds2482/i2c_dev.c is
 * the real one (libi2c and linux/i2c-dev.h), the simulated chip of hal/sim is another. Blocking,
 * each call bounded by the kernel's adapter time-out.
 */
#pragma once

#include <stddef.h>
#include <stdint.h>

#define I2C_MESSAGE_READ 1
struct i2c_message {
	uint16_t flags; /* I2C_MESSAGE_READ or 0 */
	uint16_t len;
	uint8_t *data;
};

static inline struct i2c_message i2c_to_write(uint8_t *data, size_t n)
{
	return (struct i2c_message){.len = (uint16_t)n, .data = data};
}
static inline struct i2c_message i2c_to_read(uint8_t *data, size_t n)
{
	return (struct i2c_message){.flags = I2C_MESSAGE_READ, .len = (uint16_t)n, .data = data};
}

struct i2c_adapter;
struct i2c_adapter_ops {
	/*
	 * n messages to one 7-bit address in one transaction (START, repeated STARTs, STOP).
	 * 0; -ENXIO address refused; -EIO data refused; -ENODEV adapter gone; -EOPNOTSUPP this
	 * adapter cannot (see limits); -ETIMEDOUT.
	 */
	int (*transfer)(struct i2c_adapter *adapter, uint8_t address, struct i2c_message *messages,
	                size_t n);
	/*
	 * SMBus calls for adapters that know nothing else: write one command byte; write command
	 * and one data byte; read one byte. 0 or the byte, or as transfer().
	 */
	int (*write_byte)(struct i2c_adapter *adapter, uint8_t address, uint8_t command);
	int (*write_byte_data)(struct i2c_adapter *adapter, uint8_t address, uint8_t command,
	                       uint8_t data);
	int (*read_byte)(struct i2c_adapter *adapter, uint8_t address);
	/*
	 * Claim the address for this process. -EBUSY: a kernel driver has it; -EADDRINUSE: another
	 * target has it, of process adapter->holder.
	 */
	int (*claim)(struct i2c_adapter *adapter, uint8_t address);
	/* Give the address back, as close() does. NULL: claims keep no other process out. */
	void (*release)(struct i2c_adapter *adapter, uint8_t address);
	void (*close)(struct i2c_adapter *adapter);
};

enum i2c_combine {
	I2C_SMBUS_ONLY,    /* no I2C_RDWR at all */
	I2C_ONE_READ_LAST, /* bcm2835: one read message, and it has to be the last */
	I2C_ANY,
};
struct i2c_adapter {
	const struct i2c_adapter_ops *ops;
	/*
	 * What the adapter can combine at most; the kernel does not report it, so the driver tries
	 * it and may lower it.
	 */
	enum i2c_combine combine;
	unsigned max_messages;               /* in one transfer; 42 with i2c-dev */
	uint64_t transfers, bytes, syscalls; /* counted by the adapter */
	int holder; /* the process that has a refused address; 0: not known */
};
