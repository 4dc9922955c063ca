/* SPDX-License-Identifier: MIT */
/*
 * 1-Wire operations in few I2C transactions. Waiting for an operation's end inside a transaction
 * means to read on: the chip repeats the register it points to, and a byte takes a known time. So
 * the number of bytes is the waiting time, and the last of them is the answer.
 *
 * Slow buses take 90 us a byte, too coarse a step: there, where writes are transactions of their
 * own, each begins so early after a timed wait that its command byte arrives just when the
 * operation before has ended at the latest. So it is where an adapter takes time for each message,
 * as over USB: a message to read on would take more than the wait. What the adapter takes between
 * two messages is part of that wait, as far as the chip itself shows when that was too early: it
 * refuses a command, or its status says busy. The data that a chip has read shows nothing: there
 * only the bytes on the wire count.
 */
#include <errno.h>

#include "hal/ds2482/ds2482.h"
#include "hal/ds2482/ends.h"
#include "hal/ds2482/io.h"
#include "hal/ds2482/run.h"

/* What the adapter takes between messages is left out: it may take less. */
unsigned ds2482_reading_on(const struct ds2482_chip *chip, long max_ns, unsigned between)
{
	int64_t byte = chip->master->byte_ns;
	int64_t n = 1 + (max_ns - between * byte + byte - 1) / byte;

	if (max_ns <= between * byte)
		return 1;
	return n > DS2482_MAX_BYTES ? DS2482_MAX_BYTES : (unsigned)n;
}

/* The status shows whether that was too early. */
unsigned ds2482_reading_status(const struct ds2482_chip *chip, long max_ns)
{
	int64_t left = max_ns - ds2482_between(chip);

	return ds2482_reading_on(chip, left > 0 ? (long)left : 0, 1);
}

/*
 * Only a status read after the deadline counts: the scheduler may have kept this thread from
 * running.
 */
static int wait_idle(struct ds2482_chip *chip, int status)
{
	struct ds2482_master *master = chip->master;
	int64_t stuck = ds2482_now(master) + DS2482_STUCK_NS;
	bool late = false;

	while (status >= 0 && (status & DS2482_1WB)) {
		int err;

		if (late)
			return -ETIMEDOUT;
		err = ds2482_wait(master, DS2482_POLL_NS);
		if (err)
			return err;
		late = ds2482_now(master) >= stuck;
		status = ds2482_read1(chip);
	}
	return status;
}

int ds2482_diagnose(struct ds2482_chip *chip, int err)
{
	int status;

	if (err == -ENODEV || err == -ECANCELED || err == -ETIMEDOUT)
		return err;
	if (chip->lost)
		return -ENXIO;
	status = ds2482_write2(chip, DS2482_READ_POINTER, DS2482_AT_STATUS);
	if (status == 0)
		status = ds2482_read1(chip);
	if (status >= 0 && (status & DS2482_1WB))
		ds2482_was_early(chip);
	if (status >= 0)
		status = wait_idle(chip, status);
	if (status == -ETIMEDOUT || status == -ENODEV || status == -ECANCELED)
		return status;
	if (status >= 0 && (status & DS2482_RST)) {
		chip->lost = true;
		return -ENXIO;
	}
	return -EIO;
}

int ds2482_judge(struct ds2482_chip *chip, int status)
{
	if (status >= 0 && (status & DS2482_1WB))
		ds2482_was_early(chip);
	status = wait_idle(chip, status);
	if (status < 0)
		return ds2482_diagnose(chip, status);
	chip->free_at = 0;
	if (status & DS2482_RST) {
		chip->lost = true;
		return -ENXIO;
	}
	return status;
}

static int wait_free(struct ds2482_chip *chip, int64_t ahead)
{
	return ds2482_wait_until(chip->master, chip->free_at - ahead);
}

static void ends_within(struct ds2482_chip *chip, long max_ns)
{
	chip->free_at = ds2482_now(chip->master) + max_ns;
}

int ds2482_run(struct ds2482_chip *chip, uint8_t command, int parameter, long max_ns)
{
	uint8_t out[2] = {command, (uint8_t)parameter}, in[DS2482_MAX_BYTES];
	int err = wait_free(chip, 0);

	if (err)
		return err;
	if (ds2482_combines(chip)) {
		struct i2c_adapter *adapter = chip->master->adapter;
		unsigned n = ds2482_reading_status(chip, max_ns);
		struct i2c_message messages[] = {i2c_to_write(out, parameter < 0 ? 1 : 2),
		                                 i2c_to_read(in, n)};

		err = adapter->ops->transfer(adapter, chip->address, messages, 2);
		if (err)
			return ds2482_diagnose(chip, err);
		ds2482_saw_end(&chip->ends, max_ns, in, n);
		return ds2482_judge(chip, in[n - 1]);
	}
	err = parameter < 0 ? ds2482_write1(chip, command)
	                    : ds2482_write2(chip, command, (uint8_t)parameter);
	if (err)
		return ds2482_diagnose(chip, err);
	ends_within(chip, max_ns);
	err = wait_free(chip, 0);
	return err ? err : ds2482_judge(chip, ds2482_read1(chip));
}

/* Some drivers of adapters report a refused byte as a refused address. */
bool ds2482_is_refused(int err)
{
	return err == -EIO || err == -ENXIO;
}

/* Read no status: the chip is idle when it acknowledges the next command. */
int ds2482_write_timed(struct ds2482_chip *chip, uint8_t byte)
{
	int64_t ahead = chip->master->byte_ns > 0 ? 2 * chip->master->byte_ns : 0;
	int err = wait_free(chip, ahead + ds2482_between(chip));

	if (err)
		return err;
	err = ds2482_write2(chip, DS2482_WRITE, byte);
	if (ds2482_is_refused(err))
		ds2482_was_refused(chip);
	if (err)
		return ds2482_diagnose(chip, err);
	ends_within(chip, ds2482_byte_max_ns);
	return 0;
}

int ds2482_read_timed(struct ds2482_chip *chip, uint8_t *byte)
{
	int status = ds2482_run(chip, DS2482_READ, DS2482_NO_PARAMETER, ds2482_byte_max_ns);

	if (status < 0)
		return status;
	status = ds2482_write_read(chip, DS2482_READ_POINTER, DS2482_AT_DATA);
	if (status < 0)
		return ds2482_diagnose(chip, status);
	*byte = (uint8_t)status;
	return 0;
}
