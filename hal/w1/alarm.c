/* SPDX-License-Identifier: MIT */
/*
 * sysfs has no conditional search. What a chip would answer to it is computed from what can be
 * read: a DS2408's registers, a thermometer's last value and its limits, a DS2405's switch.
 */
#include <errno.h>

#include "hal/chips/find.h"
#include "hal/chips/thermometer.h"
#include "hal/w1/w1.h"

#define OLD_NS (10 * NATIVE_S)
#define BROKEN 0x07f8
#define POWER_ON 0x0550
#define REMAIN_POWER_ON 0x0c

/* Control register of the DS2408. */
#define LATCHES 0x01 /* the condition is about the latches, not the pins */
#define ALL_OF 0x02
#define POR 0x08
#define NEVER_SET 0x70

static int64_t now_of(const struct w1_master *master)
{
	return master->master.env->now(master->master.env->ctx);
}

bool w1_alarm_converts(const struct w1_master *master, const struct w1_slave *slave)
{
	return family_of(slave->rom[0])->thermometer &&
	       (!slave->known || now_of(master) - slave->read_ns > OLD_NS);
}

/* The chip compares whole degrees, after each conversion. */
static int thermometer(struct w1_master *master, struct w1_slave *slave)
{
	uint8_t *pad = slave->scratchpad;

	if (w1_alarm_converts(master, slave)) {
		uint8_t fresh[9];
		int err = w1_scratchpad(master, slave, fresh);

		if (err)
			return err;
	}
	int raw = (int16_t)(pad[SP_LSB] | pad[SP_MSB] << 8);
	bool fixed = slave->rom[0] == 0x10;
	if (!fixed && (raw >= BROKEN || (raw == POWER_ON && pad[SP_REMAIN] == REMAIN_POWER_ON)))
		return 0;
	int shift = fixed ? 1 : 4;
	int degrees = raw >= 0 ? raw >> shift : -((-raw + (1 << shift) - 1) >> shift);
	return degrees >= (int8_t)pad[SP_HIGH] || degrees <= (int8_t)pad[SP_LOW];
}

static int byte_of(struct w1_master *master, const struct w1_slave *slave, const char *file,
                   uint8_t *byte)
{
	int n = w1_slave_read(master, slave->rom, file, byte, 1);

	return n < 0 ? n : n == 1 ? 0 : -EIO;
}

static int ds2408(struct w1_master *master, struct w1_slave *slave)
{
	uint8_t control, level;
	int err = byte_of(master, slave, "status_control", &control);

	if (err || control & NEVER_SET)
		return err ? err : -EIO;
	if (control & POR) {
		slave->condition_ns = 0;
		return 1;
	}
	if (!slave->condition_ns || now_of(master) - slave->condition_ns > OLD_NS) {
		err = byte_of(master, slave, "cond_search_mask", &slave->mask);
		if (!err)
			err = byte_of(master, slave, "cond_search_polarity", &slave->polarity);
		slave->condition_ns = err ? 0 : now_of(master);
	}
	if (!err)
		err = byte_of(master, slave, control & LATCHES ? "activity" : "state", &level);
	if (err)
		return err;
	uint8_t meets = (uint8_t) ~(level ^ slave->polarity) & slave->mask;
	return control & ALL_OF ? slave->mask && meets == slave->mask : meets != 0;
}

static int ds2405(struct w1_master *master, struct w1_slave *slave)
{
	uint8_t digit;
	int err = byte_of(master, slave, "output", &digit);

	return err ? err : digit == '0';
}

/* A slave that is being attached or removed has no attributes; without a driver it has `rw`. */
static int no_attribute(const struct w1_master *master, const struct w1_slave *slave)
{
	bool stays = w1_driver_of(master, slave->rom) || w1_slave_has(master, slave->rom, "rw");

	return stays ? -EOPNOTSUPP : -ENODEV;
}

int w1_in_alarm(struct w1_master *master, struct w1_slave *slave)
{
	int err;

	if (!w1_driver_of(master, slave->rom))
		return no_attribute(master, slave);
	if (family_of(slave->rom[0])->thermometer)
		err = thermometer(master, slave);
	else if (slave->rom[0] == 0x29)
		err = ds2408(master, slave);
	else if (slave->rom[0] == 0x05)
		err = ds2405(master, slave);
	else
		return -EOPNOTSUPP;
	return err == -ENOENT ? no_attribute(master, slave) : err;
}
