/* SPDX-License-Identifier: MIT */
/* A reset, bytes written and bytes read, in as few I2C transfers as the adapter takes. */
#include "hal/ds2482/visit.h"
#include "hal/ds2482/select.h"

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
	bool read_last; /* the last message is a read */
};

bool ds2482_visits(const struct ds2482_link *link)
{
	const struct ds2482_chip *chip = link->chip;
	const struct i2c_adapter *adapter = chip->master->adapter;

	return adapter && ds2482_reads_on(chip) &&
	       (adapter->combine != I2C_ANY || adapter->max_messages >= LEAST);
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
	int err = train->count ? ds2482_wait_until(chip->master, chip->free_at) : 0;

	if (!err && train->count)
		err = adapter->ops->transfer(adapter, chip->address, train->message, train->count);
	if (ds2482_is_refused(err)) {
		if (train->slow)
			ds2482_was_refused(chip);
		else
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
	const struct i2c_adapter *adapter = train->chip->master->adapter;
	unsigned room = adapter->max_messages < DS2482_MAX_MESSAGES ? adapter->max_messages
	                                                            : DS2482_MAX_MESSAGES;

	if (train->count + messages <= room && (train->any || !train->read_last))
		return 0;
	return train->count ? visit_send(train) : 0;
}

/* Let the time of an operation pass, unless the next message takes longer anyway. */
static void pass_time(struct train *train, enum ds2482_operation operation, long min_ns,
                      long max_ns)
{
	struct ds2482_chip *chip = train->chip;
	unsigned most = ds2482_reading_on(chip, max_ns, TO_COMMAND);

	if (ds2482_is_slow(chip, max_ns)) {
		train->max_ns = max_ns;
		return;
	}
	if (!train->slow)
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

	append_write(train, DS2482_RESET, DS2482_NO_PARAMETER);
	pass_time(train, DS2482_OF_RESET, ds2482_reset_min_ns, ds2482_reset_max_ns);
	for (size_t i = 0; !err && i < part->out_n; i++)
		err = visit_write(train, part->out[i]);
	if (!err && !few)
		err = visit_send(train);
	for (size_t i = 0; !err && i < part->in_n; i++)
		err = visit_read(train, &part->in[i]);
	return err ? err : visit_look(train);
}

/* The adapter is open: ds2482_visits() has looked. */
int ds2482_visit(struct ds2482_link *link, const struct link_part *part)
{
	struct ds2482_chip *chip = link->chip;
	struct train train;
	int err = ds2482_claimed(chip) ? ds2482_select(link) : -ENXIO;

	if (err)
		return err;
	train.chip = chip;
	train.count = train.reads = 0;
	train.max_ns = 0;
	train.any = chip->master->adapter->combine == I2C_ANY;
	train.slow = ds2482_is_slow(chip, ds2482_byte_max_ns);
	train.wait = ds2482_reading_on(chip, ds2482_byte_max_ns, TO_COMMAND);
	int status = visit_run(&train, part);

	ds2482_began(chip);
	chip->free_at = 0;
	/* a chip that has refused a command is at work, which is no sign of its being stuck */
	if (status < 0)
		err = ds2482_wait(chip->master, ds2482_reset_max_ns);
	if (status < 0)
		return err ? err : ds2482_diagnose(chip, status);
	link->cost.resets++;
	link->cost.wire_ns += (uint64_t)ds2482_reset_ns;
	if (status & DS2482_SD)
		return -ECOMM;
	if (!(status & DS2482_PPD))
		return status & DS2482_LL ? -EHOSTDOWN : -ECOMM;
	link->cost.wire_ns += 8 * (part->out_n + part->in_n) * (uint64_t)ds2482_slot_ns;
	return 0;
}
