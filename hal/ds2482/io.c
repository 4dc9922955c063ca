/* SPDX-License-Identifier: MIT */
/*
 * Single I2C calls to a chip, and what the adapter can do and how fast it is, found by trying it.
 */
#include <errno.h>

#include "hal/base/time.h"
#include "hal/bus/bus.h"
#include "hal/ds2482/ds2482.h"
#include "hal/ds2482/i2c.h"
#include "hal/ds2482/io.h"

#define MEASURE_BYTES 64
#define MEASURE_TIMES 12
#define MEASURE_MESSAGES 8
#define LEAST_NS 9000 /* 1 MHz; no wire is faster */
#define SOON_NS (60 * NS_PER_S)
#define SOON_DOUBLINGS 16

int64_t ds2482_now(const struct ds2482_master *master)
{
	return bus_now(master->master.env);
}

int ds2482_wait_until(const struct ds2482_master *master, int64_t t)
{
	const struct bus_env *env = master->master.env;
	int err;

	if (ds2482_now(master) >= t)
		return 0;
	err = env->wait(env->ctx, -1, 0, t);
	return err < 0 ? err : 0;
}

int ds2482_wait(const struct ds2482_master *master, int64_t ns)
{
	return ds2482_wait_until(master, ds2482_now(master) + ns);
}

bool ds2482_combines(const struct ds2482_chip *chip)
{
	return chip->master->adapter->combine != I2C_SMBUS_ONLY && chip->master->byte_ns > 0;
}

int ds2482_write1(struct ds2482_chip *chip, uint8_t command)
{
	struct i2c_adapter *adapter = chip->master->adapter;

	return adapter->ops->write_byte(adapter, chip->address, command);
}

int ds2482_write2(struct ds2482_chip *chip, uint8_t command, uint8_t parameter)
{
	struct i2c_adapter *adapter = chip->master->adapter;

	return adapter->ops->write_byte_data(adapter, chip->address, command, parameter);
}

int ds2482_read1(struct ds2482_chip *chip)
{
	struct i2c_adapter *adapter = chip->master->adapter;

	return adapter->ops->read_byte(adapter, chip->address);
}

int ds2482_write_read(struct ds2482_chip *chip, uint8_t command, uint8_t parameter)
{
	struct i2c_adapter *adapter = chip->master->adapter;
	uint8_t out[2] = {command, parameter}, in = 0;
	struct i2c_message messages[] = {i2c_to_write(out, 2), i2c_to_read(&in, 1)};
	int err;

	if (adapter->combine == I2C_SMBUS_ONLY) {
		err = ds2482_write2(chip, command, parameter);
		return err ? err : ds2482_read1(chip);
	}
	err = adapter->ops->transfer(adapter, chip->address, messages, 2);
	return err ? err : in;
}

/*
 * Measure the time of one I2C byte. The rate that an adapter states is not always its rate (core
 * clocks change), and reading too few bytes would read too early. The time of the call itself makes
 * a byte seem longer, so the difference of two lengths is taken. If bytes are faster than any wire,
 * or the clock is too coarse to show them, the number of bytes is no measure of time: then all
 * waits are timed.
 */
static int io_measure(struct ds2482_chip *chip)
{
	struct ds2482_master *master = chip->master;
	struct i2c_adapter *adapter = master->adapter;
	uint8_t in[1 + MEASURE_BYTES];
	int64_t shortest[2] = {INT64_MAX, INT64_MAX};

	master->byte_ns = 0;
	if (adapter->combine == I2C_SMBUS_ONLY)
		return 0;
	for (unsigned i = 0; i < MEASURE_TIMES; i++) {
		struct i2c_message message = i2c_to_read(in, i & 1 ? sizeof(in) : 1);
		int64_t begun = ds2482_now(master), took;
		int err = adapter->ops->transfer(adapter, chip->address, &message, 1);

		if (err)
			return err;
		took = ds2482_now(master) - begun;
		if (took < shortest[i & 1])
			shortest[i & 1] = took;
	}
	/* 2 % for the error of the measurement */
	master->byte_ns = (shortest[1] - shortest[0]) / MEASURE_BYTES * 98 / 100;
	if (master->byte_ns < LEAST_NS)
		master->byte_ns = 0;
	master->measured_ns = ds2482_now(master);
	return 0;
}

/*
 * If bytes come too early soon after a measurement, they are no measure of time. Noise on the bus
 * looks the same, but later; then the bus is measured again, after a longer time each time.
 */
void ds2482_was_early(struct ds2482_chip *chip)
{
	struct ds2482_master *master = chip->master;

	if (master->byte_ns == 0)
		return;
	if (ds2482_between(chip)) {
		ds2482_was_refused(chip);
		return;
	}
	master->byte_ns = master->byte_ns * 9 / 10;
	master->message_ns = master->message_ns * 9 / 10;
	if (master->byte_ns >= LEAST_NS)
		return;
	if (ds2482_now(master) < master->measured_ns + (SOON_NS << master->measured_again) ||
	    io_measure(chip))
		master->byte_ns = 0;
	if (master->measured_again < SOON_DOUBLINGS)
		master->measured_again++;
}

unsigned ds2482_room(const struct ds2482_chip *chip)
{
	unsigned most = chip->master->adapter->max_messages;

	return most < DS2482_MAX_MESSAGES ? most : DS2482_MAX_MESSAGES;
}

/* Send messages that change nothing; -EOPNOTSUPP: the adapter cannot. */
static int try_messages(struct ds2482_chip *chip, size_t writes, size_t reads)
{
	struct i2c_adapter *adapter = chip->master->adapter;
	uint8_t out[2] = {DS2482_READ_POINTER, DS2482_AT_STATUS}, in;
	struct i2c_message messages[DS2482_MAX_MESSAGES];
	size_t n = 0;

	while (writes-- > 0)
		messages[n++] = i2c_to_write(out, 2);
	while (reads-- > 0)
		messages[n++] = i2c_to_read(&in, 1);
	return adapter->ops->transfer(adapter, chip->address, messages, n);
}

/*
 * Measure the time of a message. Where it is longer than an operation of the chip, nothing has to
 * be read on between two commands, and the time that the adapter takes counts as waiting. The
 * adapter may be quicker at another time: so that is done only where the chip itself shows, by its
 * status or by refusing a command, that it was too early.
 */
static int measure_messages(struct ds2482_chip *chip)
{
	struct ds2482_master *master = chip->master;
	unsigned most = MEASURE_MESSAGES;
	int64_t shortest[2] = {INT64_MAX, INT64_MAX};

	master->message_ns = 0;
	if (master->adapter->combine != I2C_ANY || master->adapter->max_messages < most ||
	    !master->byte_ns)
		return 0;
	for (unsigned i = 0; i < MEASURE_TIMES; i++) {
		int64_t begun = ds2482_now(master), took;
		int err = try_messages(chip, i & 1 ? most : 1, 0);

		if (err)
			return err;
		took = ds2482_now(master) - begun;
		if (took < shortest[i & 1])
			shortest[i & 1] = took;
	}
	/* the mean hides the quick ones of a changing pace; 10 % for what is quicker at times */
	master->message_ns = (shortest[1] - shortest[0]) / (most - 1);
	if (shortest[0] < master->message_ns)
		master->message_ns = shortest[0];
	master->message_ns = master->message_ns * 9 / 10;
	return 0;
}

int ds2482_learn(struct ds2482_chip *chip)
{
	struct i2c_adapter *adapter = chip->master->adapter;
	int err = 0;

	if (adapter->combine == I2C_ANY) {
		err = try_messages(chip, 0, ds2482_room(chip));
		if (err == -EOPNOTSUPP)
			adapter->combine = I2C_ONE_READ_LAST;
	}
	if (adapter->combine == I2C_ONE_READ_LAST) {
		err = try_messages(chip, 2, 1);
		if (err == -EOPNOTSUPP) {
			adapter->combine = I2C_SMBUS_ONLY;
			err = 0;
		}
	}
	chip->master->measured_again = 0;
	chip->master->visit_ns = 0;
	if (!err)
		err = io_measure(chip);
	return err ? err : measure_messages(chip);
}

/* Of the shortest message, what its three bytes do not take. */
int64_t ds2482_between(const struct ds2482_chip *chip)
{
	int64_t between = chip->master->message_ns - 3 * chip->master->byte_ns;

	return between > 0 ? between : 0;
}

void ds2482_was_refused(struct ds2482_chip *chip)
{
	if (!ds2482_between(chip))
		return;
	chip->master->message_ns = chip->master->message_ns * 9 / 10;
}
