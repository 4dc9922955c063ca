/* SPDX-License-Identifier: MIT */
/* One channel of a chip as a link. */
#include <errno.h>

#include "hal/ds2482/detect.h"
#include "hal/ds2482/ds2482.h"
#include "hal/ds2482/io.h"
#include "hal/ds2482/link.h"
#include "hal/ds2482/power.h"
#include "hal/ds2482/run.h"
#include "hal/ds2482/select.h"
#include "hal/ds2482/together.h"
#include "hal/ds2482/visit.h"

static void spend_slots(struct ds2482_link *link, size_t n)
{
	link->cost.wire_ns += n * (uint64_t)ds2482_slot_ns;
}

/* Set SPU before the operation after whose last bit the pull-up feeds the wire. */
static int arm_pullup(struct ds2482_chip *chip)
{
	return ds2482_configure(chip, chip->config | DS2482_SPU);
}

/* A reset, and with it all of a whole transaction; NULL: alone. */
static int link_begin(struct ds2482_link *link, const struct link_part *whole)
{
	struct ds2482_chip *chip = link->chip;
	int status = ds2482_claimed(chip) ? ds2482_select(link) : -ENXIO;

	if (status < 0)
		return status;
	status = whole ? ds2482_visit(chip, whole)
	               : ds2482_run(chip, DS2482_RESET, DS2482_NO_PARAMETER, ds2482_reset_max_ns);
	if (status < 0)
		return status;
	ds2482_began(chip);
	return ds2482_presence(link, status);
}

static int write_strong(struct ds2482_chip *chip, const uint8_t *data, size_t n)
{
	const struct link_part head = {.out = data, .out_n = n - 1},
			       last = {.out = data + n - 1, .out_n = 1};
	int err = n > 1 ? ds2482_visit(chip, &head) : 0;

	if (n > 1)
		ds2482_began(chip);
	if (err >= 0)
		err = arm_pullup(chip);
	if (err >= 0)
		err = ds2482_visit(chip, &last);
	/* the pull-up begins with the last slot of the byte, and so does its time */
	return err < 0 ? err : ds2482_wait_until(chip->master, chip->free_at);
}

/* The transaction goes on: bytes written, then bytes read. */
static int link_go_on(struct ds2482_link *link, const struct link_part *part)
{
	const struct link_part out = {.out = part->out, .out_n = part->out_n},
			       in = {.in = part->in, .in_n = part->in_n};
	bool strong = part->out_n && part->after == LINK_STRONG;
	int err = ds2482_select(link);

	if (err < 0)
		return err;
	if (part->out_n)
		err = strong ? write_strong(link->chip, part->out, part->out_n)
		             : ds2482_visit(link->chip, &out);
	if (!strong)
		ds2482_began(link->chip);
	return err >= 0 && part->in_n ? ds2482_visit(link->chip, &in) : err;
}

static int link_run(struct link *base, const struct link_part *part)
{
	struct ds2482_link *link = ds2482_link_of(base);
	bool whole = part->reset && part->in_n && ds2482_visits(link->chip);
	int err = part->reset ? link_begin(link, whole ? part : NULL) : 0;

	if (err >= 0 && !whole && (part->out_n || part->in_n))
		err = link_go_on(link, part);
	if (err < 0)
		return err;
	spend_slots(link, 8 * (part->out_n + part->in_n));
	return 0;
}

static int link_bit(struct link *base, bool out, enum link_after after)
{
	struct ds2482_link *link = ds2482_link_of(base);
	int status = ds2482_select(link);

	if (status == 0 && after == LINK_STRONG)
		status = arm_pullup(link->chip);
	if (status == 0)
		status = ds2482_run(link->chip, DS2482_BIT, out ? 0x80 : 0, ds2482_slot_max_ns);
	if (status < 0)
		return status;
	if (after != LINK_STRONG)
		ds2482_began(link->chip);
	spend_slots(link, 1);
	return status & DS2482_SBR ? 1 : 0;
}

static int link_triplet(struct link *base, bool direction)
{
	struct ds2482_link *link = ds2482_link_of(base);
	int status = ds2482_select(link);

	if (status < 0)
		return status;
	status = ds2482_run(link->chip, DS2482_TRIPLET, direction ? 0x80 : 0,
	                    3 * ds2482_slot_max_ns);
	if (status < 0)
		return status;
	ds2482_began(link->chip);
	spend_slots(link, 3);
	return (status & DS2482_SBR ? 1 : 0) | (status & DS2482_TSB ? 2 : 0) |
	       (status & DS2482_DIR ? 4 : 0);
}

static int power_cycle(struct ds2482_link *link)
{
	struct ds2482_chip *chip = link->chip;
	int err = ds2482_power_cycle(chip->master);

	if (err != -EOPNOTSUPP || chip->part != DS2482_ADJUSTABLE)
		return err;
	err = ds2482_select(link);
	if (!err)
		err = ds2482_configure(chip, (chip->config & DS2482_APU) | DS2482_PDN);
	if (!err)
		err = ds2482_wait(chip->master, DS2482_POWER_OFF_NS);
	if (!err)
		err = ds2482_configure(chip, chip->config & DS2482_APU);
	if (!err)
		err = ds2482_wait(chip->master, DS2482_POWER_ON_NS);
	return err;
}

static int link_recover(struct link *base, enum link_rung rung)
{
	struct ds2482_link *link = ds2482_link_of(base);
	struct ds2482_chip *chip = link->chip;
	bool lost = chip->lost;
	int err;

	if (!chip->master->adapter)
		return -ENODEV;
	switch (rung) {
	case LINK_BUS_RESET:
		err = link_begin(link, NULL);
		return err == -EHOSTDOWN ? 0 : err;
	case LINK_CHIP_RESET:
		/* a kernel driver may have taken the chip, whose reset looks like this */
		err = chip->master->adapter->ops->claim(chip->master->adapter, chip->address);
		err = err ? err : ds2482_setup(chip);
		if (!err && lost)
			chip->master->changed = chip->address;
		return err;
	case LINK_POWER_CYCLE:
		return power_cycle(link);
	case LINK_RUNGS:
		break;
	}
	return -EINVAL;
}

static void link_cost(const struct link *base, struct link_cost *cost)
{
	*cost = ((const struct ds2482_link *)base)->cost;
}

static const struct link_ops link_ops = {
	.name = "DS2482",
	.run = link_run,
	.slot = link_bit,
	.triplet = link_triplet,
	.run_many = ds2482_together,
	.many = ds2482_many,
	.recover = link_recover,
	.cost = link_cost,
};

static const struct link_facts facts = {.strong = true, .splits = true};

/*
 * A link that is opened again keeps its chip number, which the master of several adapters may have
 * given.
 */
void ds2482_link_init(struct ds2482_chip *chip, unsigned number)
{
	const struct link *before = &chip->link[number].link;
	unsigned own = (unsigned)(chip - chip->master->chip);

	chip->link[number] = (struct ds2482_link){
		.link = {.ops = &link_ops,
	                 .facts = &facts,
	                 .env = chip->master->master.env,
	                 .chip = before->ops ? before->chip : own},
		.chip = chip,
		.number = (uint8_t)number,
		.cost = chip->link[number].cost,
	};
}
