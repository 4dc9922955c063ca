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
#include <assert.h>
#include <errno.h>
#include <string.h>

#include "hal/ds2482/ds2482.h"
#include "hal/ds2482/ends.h"
#include "hal/ds2482/io.h"
#include "hal/ds2482/run.h"

/* Reading on pays with bytes of at most 45 us (200 kHz). */
#define FAST_BYTE_NS 45000
#define BETWEEN_NS 100000

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

static int transfer_all(struct ds2482_chip *chip, struct i2c_message *messages, size_t n)
{
	struct i2c_adapter *adapter = chip->master->adapter;

	return adapter->ops->transfer(adapter, chip->address, messages, n);
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

/* Returns the last status of an operation, or its error. */
static int judge_status(struct ds2482_chip *chip, int status)
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
		unsigned n = ds2482_reading_status(chip, max_ns);
		struct i2c_message messages[] = {i2c_to_write(out, parameter < 0 ? 1 : 2),
		                                 i2c_to_read(in, n)};

		err = transfer_all(chip, messages, 2);
		if (err)
			return ds2482_diagnose(chip, err);
		ds2482_saw_end(&chip->ends, max_ns, in, n);
		return judge_status(chip, in[n - 1]);
	}
	err = parameter < 0 ? ds2482_write1(chip, command)
	                    : ds2482_write2(chip, command, (uint8_t)parameter);
	if (err)
		return ds2482_diagnose(chip, err);
	ends_within(chip, max_ns);
	err = wait_free(chip, 0);
	return err ? err : judge_status(chip, ds2482_read1(chip));
}

/* --- Writing ---------------------------------------------------------------------------------- */

/* If it does not after all, the chip refuses the next command. */
bool ds2482_is_slow(const struct ds2482_chip *chip, long max_ns)
{
	return chip->master->message_ns > max_ns;
}

/* Some drivers of adapters report a refused byte as a refused address. */
bool ds2482_is_refused(int err)
{
	return err == -EIO || err == -ENXIO;
}

/*
 * Two bytes of the next write pass before the chip looks at its command. So only the last byte of
 * data is read on to its end (with `last`), and only its status counts. Between two bytes nothing
 * is read where messages are slow.
 */
static int write_combined(struct ds2482_chip *chip, const uint8_t *data, size_t n, bool last)
{
	const long max_ns = ds2482_byte_max_ns;
	struct i2c_message messages[DS2482_MAX_MESSAGES];
	uint8_t out[DS2482_MAX_MESSAGES][2], in[DS2482_MAX_BYTES];
	unsigned between = ds2482_reading_on(chip, max_ns, 4),
		 end = ds2482_reading_status(chip, max_ns);
	bool slow = ds2482_is_slow(chip, max_ns);
	size_t count = 0;
	int err;

	assert(slow ? n < DS2482_MAX_MESSAGES : n <= DS2482_MAX_MESSAGES / 2);
	for (size_t i = 0; i < n; i++) {
		bool whole = last && i + 1 == n;

		out[i][0] = DS2482_WRITE;
		out[i][1] = data[i];
		messages[count++] = i2c_to_write(out[i], 2);
		if (whole || !slow)
			messages[count++] = i2c_to_read(in, whole ? end : between);
	}
	err = transfer_all(chip, messages, count);
	if (ds2482_is_refused(err) && slow)
		ds2482_was_refused(chip);
	if (err)
		return ds2482_diagnose(chip, err);
	if (slow && !last)
		chip->free_at = ds2482_now(chip->master) + max_ns;
	if (last)
		ds2482_saw_end(&chip->ends, max_ns, in, end);
	return last ? judge_status(chip, in[end - 1]) : 0;
}

/* Read no status: the chip is idle when it acknowledges the next command. */
static int write_timed(struct ds2482_chip *chip, uint8_t byte)
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

size_t ds2482_batch(const struct ds2482_chip *chip, unsigned messages_each)
{
	const struct i2c_adapter *adapter = chip->master->adapter;
	unsigned room = adapter->max_messages < DS2482_MAX_MESSAGES ? adapter->max_messages
	                                                            : DS2482_MAX_MESSAGES;

	return adapter->combine == I2C_ANY && room > messages_each ? room / messages_each : 1;
}

bool ds2482_reads_on(const struct ds2482_chip *chip)
{
	bool slow = ds2482_is_slow(chip, ds2482_byte_max_ns);

	/* A message between takes longer than what is left to wait. */
	if (!ds2482_combines(chip) || (ds2482_between(chip) > BETWEEN_NS && !slow))
		return false;
	return chip->master->byte_ns <= FAST_BYTE_NS || ds2482_batch(chip, slow ? 1 : 2) > 1;
}

int ds2482_write_block(struct ds2482_chip *chip, const uint8_t *data, size_t n)
{
	bool slow = ds2482_is_slow(chip, ds2482_byte_max_ns);
	size_t most = ds2482_batch(chip, slow ? 1 : 2);
	int err = 0;

	if (!ds2482_reads_on(chip)) {
		while (n-- > 0 && err >= 0)
			err = write_timed(chip, *data++);
		return err;
	}
	/* The status is read after the last byte. */
	if (slow && most > 1)
		most--;
	while (n > 0 && err >= 0) {
		size_t now = n < most ? n : most;

		err = wait_free(chip, 0);
		if (!err)
			err = write_combined(chip, data, now, now == n);
		data += now;
		n -= now;
	}
	return err < 0 ? err : 0;
}

/* --- Reading ---------------------------------------------------------------------------------- */

/*
 * The pointer may be set while the operation runs, so the data register is read on. With `check`
 * the status is read after it: was the chip idle, and is it still set up?
 */
static int read_combined(struct ds2482_chip *chip, uint8_t *data, size_t n, bool check)
{
	uint8_t read = DS2482_READ, at_data[] = {DS2482_READ_POINTER, DS2482_AT_DATA};
	uint8_t at_status[] = {DS2482_READ_POINTER, DS2482_AT_STATUS};
	struct i2c_message messages[DS2482_MAX_MESSAGES];
	uint8_t in[DS2482_MAX_MESSAGES / 3][DS2482_MAX_BYTES], status = 0;
	unsigned wait = ds2482_reading_on(chip, ds2482_byte_max_ns, 4);
	size_t count = 0;
	int err;

	assert(3 * n + 2 <= DS2482_MAX_MESSAGES);
	for (size_t i = 0; i < n; i++) {
		messages[count++] = i2c_to_write(&read, 1);
		messages[count++] = i2c_to_write(at_data, 2);
		messages[count++] = i2c_to_read(in[i], wait);
	}
	if (check) {
		messages[count++] = i2c_to_write(at_status, 2);
		messages[count++] = i2c_to_read(&status, 1);
	}
	err = transfer_all(chip, messages, count);
	if (err)
		return ds2482_diagnose(chip, err);
	for (size_t i = 0; i < n; i++)
		data[i] = in[i][wait - 1];
	return status & (DS2482_1WB | DS2482_RST) ? ds2482_diagnose(chip, -EIO) : 0;
}

static int read_timed(struct ds2482_chip *chip, uint8_t *byte)
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

int ds2482_read_block(struct ds2482_chip *chip, uint8_t *data, size_t n)
{
	size_t most = (DS2482_MAX_MESSAGES - 2) / 3;
	bool any = ds2482_batch(chip, 3) > 1;
	int err = 0, status;

	if (!ds2482_combines(chip)) {
		while (n-- > 0 && err == 0)
			err = read_timed(chip, data++);
		return err;
	}
	if (any && chip->master->adapter->max_messages < DS2482_MAX_MESSAGES)
		most = (chip->master->adapter->max_messages - 2) / 3;
	if (!any || most == 0)
		most = 1;
	err = wait_free(chip, 0);
	while (n > 0 && err == 0) {
		size_t now = n < most ? n : most;

		err = read_combined(chip, data, now, any);
		data += now;
		n -= now;
	}
	if (err || any)
		return err;
	status = ds2482_write_read(chip, DS2482_READ_POINTER, DS2482_AT_STATUS);
	if (status < 0 || (status & (DS2482_1WB | DS2482_RST)))
		return ds2482_diagnose(chip, status < 0 ? status : -EIO);
	return 0;
}
