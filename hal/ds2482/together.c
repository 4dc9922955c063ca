/* SPDX-License-Identifier: MIT */
/* Transactions of several chips at the same time, operation by operation. */
#include <assert.h>
#include <errno.h>

#include "hal/ds2482/ds2482.h"
#include "hal/ds2482/io.h"
#include "hal/ds2482/select.h"
#include "hal/ds2482/together.h"

/* A group may hold the I2C bus for this long, little more than one transaction does. */
#define GROUP_NS (20 * NS_PER_MS)
/* Bytes on the I2C bus of a transaction that reads a scratchpad, conditions included. */
#define VISIT_BYTES 105
#define VISIT_MESSAGES 41
#define MEAN_OF 8

/* What a chip's next I2C transaction is. */
enum step { STEP_BEGIN, STEP_PRESENCE, STEP_WRITE, STEP_READ, STEP_FETCH, STEP_DONE };

/* A transaction on its way, from step to step. */
struct course {
	struct link_run *run;
	struct ds2482_link *link;
	enum step step;
	unsigned at;      /* bytes written, then bytes read */
	int64_t ready_ns; /* when the next step may be made */
	int64_t stuck_ns; /* reset: a chip that is busy after that stays so */
	int64_t busy_ns;  /* of the I2C bus, so far */
};

static void together_end(struct course *course, int err)
{
	course->run->err = err;
	course->run->ended_ns = ds2482_now(course->link->chip->master);
	course->step = STEP_DONE;
}

/*
 * One message, with its address: the SMBus calls of i2c-dev would have the address set anew for
 * each other chip. Adapters that have nothing else take no group (ds2482_many()).
 */
static int transfer_one(const struct ds2482_chip *chip, uint16_t flags, uint8_t *data, uint16_t n)
{
	struct i2c_adapter *adapter = chip->master->adapter;
	struct i2c_message one = {.flags = flags, .len = n, .data = data};

	return adapter->ops->transfer(adapter, chip->address, &one, 1);
}

static int together_command(const struct ds2482_chip *chip, uint8_t code)
{
	return transfer_one(chip, 0, &code, 1);
}

/*
 * An operation of at most max_ns has begun. The next step may begin so many bytes before its end as
 * pass on the I2C bus before the chip looks at it.
 */
static void set_ready(struct course *course, enum step next, int64_t max_ns, unsigned ahead)
{
	struct ds2482_chip *chip = course->link->chip;
	int64_t byte_ns = chip->master->byte_ns;

	chip->free_at = ds2482_now(chip->master) + max_ns;
	course->ready_ns = chip->free_at - ahead * byte_ns;
	course->step = next;
}

static int together_begin(struct course *course)
{
	struct ds2482_link *link = course->link;
	int err = ds2482_claimed(link->chip) ? ds2482_select(link) : -ENXIO;

	if (!err)
		err = ds2482_wait_until(link->chip->master, link->chip->free_at);
	if (!err)
		err = together_command(link->chip, DS2482_RESET);
	if (err)
		return err;
	ds2482_began(link->chip);
	set_ready(course, STEP_PRESENCE, ds2482_reset_max_ns, 0);
	course->stuck_ns = link->chip->free_at + DS2482_STUCK_NS;
	return 0;
}

static int write_byte_next(struct course *course)
{
	struct ds2482_link *link = course->link;
	const struct link_part *part = &course->run->part;
	uint8_t bytes[2] = {DS2482_WRITE, part->out[course->at]};
	int err = transfer_one(link->chip, 0, bytes, sizeof(bytes));

	if (err)
		return err;
	bool last = ++course->at == part->out_n;
	set_ready(course, last ? STEP_READ : STEP_WRITE, ds2482_byte_max_ns, 2);
	if (last)
		course->at = 0;
	return 0;
}

static int begin_read(struct course *course)
{
	struct ds2482_link *link = course->link;
	int err = together_command(link->chip, DS2482_READ);

	/* the register is read after the pointer and two addresses */
	if (!err)
		set_ready(course, STEP_FETCH, ds2482_byte_max_ns, 4);
	return err;
}

static int look_for_presence(struct course *course)
{
	struct ds2482_link *link = course->link;
	bool late = ds2482_now(link->chip->master) >= course->stuck_ns;
	uint8_t status;
	int err = transfer_one(link->chip, I2C_MESSAGE_READ, &status, 1);

	if (err)
		return err;
	if (status & DS2482_1WB) {
		course->ready_ns = ds2482_now(link->chip->master) + DS2482_POLL_NS;
		return late ? -EIO : 0; /* of this chip alone */
	}
	if (status & DS2482_RST)
		return -ENXIO;
	err = ds2482_presence(link, status);
	return err ? err : write_byte_next(course);
}

/* One byte is fetched; after the last the status says whether the chip was idle, and is set up. */
static int fetch_byte(struct course *course)
{
	struct ds2482_link *link = course->link;
	const struct link_part *part = &course->run->part;
	int byte = ds2482_write_read(link->chip, DS2482_READ_POINTER, DS2482_AT_DATA), status;

	if (byte < 0)
		return byte;
	part->in[course->at++] = (uint8_t)byte;
	if (course->at < part->in_n)
		return begin_read(course);
	status = ds2482_write_read(link->chip, DS2482_READ_POINTER, DS2482_AT_STATUS);
	if (status < 0)
		return status;
	if (status & (DS2482_1WB | DS2482_RST))
		return -EIO;
	link->chip->free_at = 0;
	link->cost.wire_ns += 8 * (part->out_n + part->in_n) * (uint64_t)ds2482_slot_ns;
	together_end(course, 0);
	return 0;
}

static void make_step(struct course *course)
{
	int err = 0;

	switch (course->step) {
	case STEP_BEGIN:
		err = together_begin(course);
		break;
	case STEP_PRESENCE:
		err = look_for_presence(course);
		break;
	case STEP_WRITE:
		err = write_byte_next(course);
		break;
	case STEP_READ:
		err = begin_read(course);
		break;
	case STEP_FETCH:
		err = fetch_byte(course);
		break;
	case STEP_DONE:
		break;
	}
	if (err)
		together_end(course, err);
}

/* NULL: all are done. */
static struct course *soonest(struct course *courses, unsigned n)
{
	struct course *first = NULL;

	for (unsigned i = 0; i < n; i++)
		if (courses[i].step != STEP_DONE &&
		    (!first || courses[i].ready_ns < first->ready_ns))
			first = &courses[i];
	return first;
}

/* What a transaction takes of its own I2C bus, waits for the chips left out. */
static void learn_visit_time(const struct course *course)
{
	struct ds2482_master *master = course->link->chip->master;

	if (!master->visit_ns)
		master->visit_ns = course->busy_ns;
	master->visit_ns += (course->busy_ns - master->visit_ns) / MEAN_OF;
}

/*
 * Each transfer on a bus whose lines are held takes the kernel's time-out. So one is enough: all
 * others of that adapter end with it.
 */
static void end_others(struct course *courses, unsigned n, const struct course *failed)
{
	for (unsigned i = 0; i < n; i++)
		if (courses[i].step != STEP_DONE &&
		    courses[i].link->chip->master == failed->link->chip->master)
			together_end(&courses[i], failed->run->err);
}

static bool is_of_adapter(int err)
{
	return err == -ETIMEDOUT || err == -ENODEV || err == -ECANCELED;
}

void ds2482_together(struct link_run *runs, unsigned n)
{
	struct course courses[LINK_MANY], *course;

	assert(n > 0 && n <= LINK_MANY);
	for (unsigned i = 0; i < n; i++) {
		assert(runs[i].part.out_n > 0 && runs[i].part.in_n > 0);
		courses[i] = (struct course){.run = &runs[i], .link = ds2482_link_of(runs[i].link)};
	}
	while ((course = soonest(courses, n))) {
		const struct ds2482_master *master = course->link->chip->master;
		int err = ds2482_wait_until(master, course->ready_ns);
		int64_t begun_ns = ds2482_now(master);

		if (err)
			together_end(course, err);
		else
			make_step(course);
		course->busy_ns += ds2482_now(master) - begun_ns;
		if (course->step == STEP_DONE && is_of_adapter(course->run->err))
			end_others(courses, n, course);
	}
	for (unsigned i = 0; i < n; i++)
		if (!runs[i].err)
			learn_visit_time(&courses[i]);
}

/*
 * As many as take no more of the I2C bus than GROUP_NS. What the calls take is not known before
 * there was a group; where bytes and messages alone leave room for two, two are always worth it.
 */
unsigned ds2482_many(const struct link *link)
{
	const struct ds2482_chip *chip = ((const struct ds2482_link *)link)->chip;
	const struct ds2482_master *master = chip->master;
	int64_t least_ns = VISIT_BYTES * master->byte_ns, n;

	least_ns += VISIT_MESSAGES * ds2482_between(chip);
	if (!master->adapter || least_ns <= 0 || 2 * least_ns > GROUP_NS)
		return 1;
	n = GROUP_NS / (master->visit_ns > least_ns ? master->visit_ns : least_ns);
	if (n < 2)
		return 2;
	return n > LINK_MANY ? LINK_MANY : (unsigned)n;
}
