/* SPDX-License-Identifier: MIT */
/* A reset, bytes written and bytes read, in as few I2C transfers as the adapter takes. */
#include "hal/ds2482/visit.h"

#include <errno.h>

#include "hal/ds2482/ds2482.h"
#include "hal/ds2482/ends.h"
#include "hal/ds2482/io.h"
#include "hal/ds2482/run.h"

/* No byte is read across two transfers, and a transfer has the messages of one byte at least. */
#define READS (DS2482_MAX_MESSAGES / 3)
/* The I2C bus is not held for longer than by a block of bytes: more are read in a transfer anew. */
#define FEW_READS 2
#define LEAST 3
/* Bytes on the I2C bus between a pause and the chip's look at the next command. */
#define TO_COMMAND 4
/* Reading on pays with bytes of at most 45 us (200 kHz). */
#define FAST_BYTE_NS 45000
#define BETWEEN_NS 100000

/* The messages that are gathered for the next transfer. */
struct train {
	struct ds2482_chip *chip;
	struct i2c_message message[DS2482_MAX_MESSAGES];
	uint8_t out[DS2482_MAX_MESSAGES][2];
	uint8_t in[READS][DS2482_MAX_BYTES], pause[DS2482_MAX_BYTES];
	uint8_t *byte[READS]; /* where the last byte of each in[] belongs */
	unsigned count, reads, wait;
	long max_ns; /* of the operation with which it ends; 0: that has ended */
	bool any, slow;
	bool learnt;    /* the pauses are as long as the chip was seen to take */
	bool read_last; /* the last message is a read */
};

/*
 * Does a message take longer than a byte on the wire? Then nothing is read between two; if it does
 * not after all, the chip refuses the next command.
 */
static bool is_slow(const struct ds2482_chip *chip, long max_ns)
{
	return chip->master->message_ns > max_ns;
}

/* Is time passed by reading on, and not by timed waits, between bytes that are written? */
static bool reads_on(const struct ds2482_chip *chip)
{
	bool slow = is_slow(chip, ds2482_byte_max_ns);

	/* A message between takes longer than what is left to wait. */
	if (!ds2482_combines(chip) || (ds2482_between(chip) > BETWEEN_NS && !slow))
		return false;
	return chip->master->byte_ns <= FAST_BYTE_NS ||
	       (chip->master->adapter->combine == I2C_ANY && ds2482_room(chip) >= (slow ? 2 : 4));
}

/* Is a byte read in one transfer? */
static bool reads_whole(const struct ds2482_chip *chip)
{
	return ds2482_combines(chip) &&
	       (chip->master->adapter->combine != I2C_ANY || ds2482_room(chip) >= LEAST);
}

bool ds2482_visits(const struct ds2482_chip *chip)
{
	return chip->master->adapter && reads_on(chip) && reads_whole(chip);
}

static void append_write(struct train *train, uint8_t command, int parameter)
{
	uint8_t *bytes = train->out[train->count];

	bytes[0] = command;
	bytes[1] = (uint8_t)parameter;
	train->message[train->count++] = i2c_to_write(bytes, parameter < 0 ? 1 : 2);
	train->read_last = false;
}

static void append_read(struct train *train, uint8_t *bytes, unsigned n)
{
	train->message[train->count++] = i2c_to_read(bytes, n);
	train->read_last = true;
}

/* Transfer what was gathered. */
static int visit_send(struct train *train)
{
	struct ds2482_chip *chip = train->chip;
	struct i2c_adapter *adapter = chip->master->adapter;

	if (!train->count)
		return 0;
	int err = ds2482_wait_until(chip->master, chip->free_at);
	if (!err)
		err = adapter->ops->transfer(adapter, chip->address, train->message, train->count);
	if (ds2482_is_refused(err)) {
		if (train->slow)
			ds2482_was_refused(chip);
		else if (train->learnt)
			ds2482_forget_ends(&chip->ends);
	}
	for (unsigned i = 0; !err && i < train->reads; i++)
		*train->byte[i] = train->in[i][train->wait - 1];
	chip->free_at = ds2482_now(chip->master) + train->max_ns;
	train->count = train->reads = 0;
	train->max_ns = 0;
	return err;
}

/* Room for another operation of so many messages. A read ends what a bcm2835 can combine. */
static int make_room_for(struct train *train, unsigned messages)
{
	bool fits = train->count + messages <= ds2482_room(train->chip);

	return fits && (train->any || !train->read_last) ? 0 : visit_send(train);
}

/* Let the time of an operation pass, unless the next message takes longer anyway. */
static void pass_time(struct train *train, enum ds2482_operation operation, long min_ns,
                      long max_ns)
{
	struct ds2482_chip *chip = train->chip;
	unsigned most = ds2482_reading_on(chip, max_ns, TO_COMMAND);

	if (is_slow(chip, max_ns)) {
		train->max_ns = max_ns;
		return;
	}
	if (train->learnt && !train->slow)
		most = ds2482_pause(&chip->ends, operation,
		                    ds2482_reading_on(chip, min_ns, TO_COMMAND), most);
	append_read(train, train->pause, most);
	train->max_ns = 0;
}

static int visit_write(struct train *train, uint8_t byte)
{
	int err = make_room_for(train, 2);

	if (err)
		return err;
	append_write(train, DS2482_WRITE, byte);
	pass_time(train, DS2482_OF_BYTE, 8 * ds2482_slot_min_ns, ds2482_byte_max_ns);
	return 0;
}

/* The last byte where none is read: its status, read on to its end. */
static int visit_write_last(struct train *train, uint8_t byte)
{
	unsigned n = ds2482_reading_status(train->chip, ds2482_byte_max_ns);
	int err = make_room_for(train, 2);

	if (err)
		return err;
	append_write(train, DS2482_WRITE, byte);
	append_read(train, train->pause, n);
	train->max_ns = 0;
	err = visit_send(train);
	if (err)
		return err;
	ds2482_saw_end(&train->chip->ends, ds2482_byte_max_ns, train->pause, n);
	return train->pause[n - 1];
}

static int visit_read(struct train *train, uint8_t *byte)
{
	int err = train->reads == READS ? visit_send(train) : make_room_for(train, 3);

	if (err)
		return err;
	append_write(train, DS2482_READ, DS2482_NO_PARAMETER);
	append_write(train, DS2482_READ_POINTER, DS2482_AT_DATA);
	train->byte[train->reads] = byte;
	append_read(train, train->in[train->reads++], train->wait);
	train->max_ns = 0;
	return 0;
}

/* The status: was the chip idle, is it still set up, and did a slave answer the reset? */
static int visit_look(struct train *train)
{
	uint8_t status;
	int err = make_room_for(train, 2);

	if (err)
		return err;
	append_write(train, DS2482_READ_POINTER, DS2482_AT_STATUS);
	append_read(train, &status, 1);
	err = visit_send(train);
	if (err)
		return err;
	if (status & DS2482_1WB)
		ds2482_was_early(train->chip);
	return status & (DS2482_1WB | DS2482_RST) ? -EIO : status;
}

static int visit_run(struct train *train, const struct link_part *part)
{
	bool few = train->slow || part->in_n <= FEW_READS;
	int err = 0;

	if (part->reset) {
		append_write(train, DS2482_RESET, DS2482_NO_PARAMETER);
		pass_time(train, DS2482_OF_RESET, ds2482_reset_min_ns, ds2482_reset_max_ns);
	}
	for (size_t i = 0; !err && i < part->out_n; i++) {
		if (!part->in_n && i + 1 == part->out_n)
			return visit_write_last(train, part->out[i]);
		err = visit_write(train, part->out[i]);
	}
	if (!err && !few)
		err = visit_send(train);
	for (size_t i = 0; !err && i < part->in_n; i++)
		err = visit_read(train, &part->in[i]);
	return err ? err : visit_look(train);
}

static int visit_timed(struct ds2482_chip *chip, const struct link_part *part)
{
	int err = 0;

	for (size_t i = 0; !err && i < part->out_n; i++)
		err = ds2482_write_timed(chip, part->out[i]);
	for (size_t i = 0; !err && i < part->in_n; i++)
		err = ds2482_read_timed(chip, &part->in[i]);
	return err;
}

int ds2482_visit(struct ds2482_chip *chip, const struct link_part *part)
{
	struct train train;

	if (part->in_n ? !reads_whole(chip) : !reads_on(chip))
		return visit_timed(chip, part);
	train.chip = chip;
	train.count = train.reads = 0;
	train.max_ns = 0;
	train.read_last = false;
	train.any = chip->master->adapter->combine == I2C_ANY;
	train.slow = is_slow(chip, ds2482_byte_max_ns);
	train.learnt = part->reset;
	train.wait = ds2482_reading_on(chip, ds2482_byte_max_ns, TO_COMMAND);
	int status = visit_run(&train, part), err;

	chip->free_at = 0;
	if (status >= 0)
		return part->in_n ? status : ds2482_judge(chip, status);
	/* a chip that has refused a command is at work, which is no sign of its being stuck */
	err = ds2482_wait(chip->master, ds2482_reset_max_ns);
	return err ? err : ds2482_diagnose(chip, status);
}
