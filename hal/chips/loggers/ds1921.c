/* SPDX-License-Identifier: MIT */
/* DS1921: areas, versions, and what is read: clock, missions, logs, the times beyond a limit. */
#include "hal/chips/loggers/ds1921.h"

#include <errno.h>
#include <string.h>

#include "hal/chips/family.h"

#define CHECKED .address_bytes = 2, .read = 0xa5, .block = DS1921_PAGE, .check = AREA_CRC16

AREA_NAMED(ds1921_memory, "memory", .size = 512, CHECKED, .row = DS1921_PAGE, .write = 0x0f,
           .verify = 0xaa, .copy = 0x55, .write_crc16 = true, .copy_ns = TXN_MS);
AREA_NAMED(ds1921_registers, "registers", .at = LOGGER_REGISTERS, .size = DS1921_REGISTERS_END,
           CHECKED);
AREA_NAMED(ds1921_histogram, "histogram", .at = 0x800, .size = 128, CHECKED);
AREA_NAMED(ds1921_log, "log", .at = 0x1000, .size = DS1921_LOG_ROOM, CHECKED);

const struct ds1921_version *ds1921_version_of(const struct device *device)
{
	static const struct ds1921_version versions[] = {
		{0x000, 90, "DS1921G-F5", -40, 0.5, -40, 85},
		{0x064, 300, "DS1921L-F50", -40, 0.5, -40, 85},
		{0x15c, 300, "DS1921L-F53", -40, 0.5, -30, 85},
		{0x254, 300, "DS1921L-F52", -40, 0.5, -20, 85},
		{0x34c, 300, "DS1921L-F51", -40, 0.5, -10, 85},
		{0x3b2, 360, "DS1921Z-F5", -5.5, 0.125, -5, 26},
		{0x4f2, 360, "DS1921H-F5", 14.5, 0.125, 15, 46},
	};
	unsigned id = device->rom[5] >> 4 | device->rom[6] << 4;

	for (unsigned i = 0; i < sizeof(versions) / sizeof(versions[0]); i++) {
		if (versions[i].id == id)
			return &versions[i];
	}
	return NULL;
}

double ds1921_celsius(const struct ds1921_version *version, unsigned code)
{
	return version->zero + code * version->step;
}

/* arg: what of the version. */
int ds1921_read_version(struct txn *txn)
{
	const struct ds1921_version *version = ds1921_version_of(txn->device);

	if (!version)
		return -EMEDIUMTYPE;
	switch (txn->property->arg) {
	case DS1921_RESOLUTION:
		txn->number[0] = version->step;
		break;
	case DS1921_LEAST:
		txn->number[0] = version->least;
		break;
	case DS1921_MOST:
		txn->number[0] = version->most;
		break;
	case DS1921_GAP:
		txn->number[0] = 4 * version->step;
		break;
	case DS1921_BIN:
		txn->number[0] = ds1921_celsius(version, 4 * (unsigned)txn->element);
		break;
	default:
		return property_text(txn, version->name);
	}
	return 0;
}

int ds1921_read_bins(struct txn *txn)
{
	txn->number[0] = DS1921_BINS;
	return 0;
}

/* The stamp has no seconds, and its month may be without a century. */
static int ds1921_mission(struct txn *txn, struct logger_mission *mission)
{
	uint8_t page[DS1921_PAGE];
	int err = area_read(txn, &ds1921_registers, 0, page, DS1921_PAGE);

	if (err)
		return err;
	mission->interval = 60 * page[DS1921_RATE];
	mission->samples = logger_count(page + DS1921_SAMPLES, 3);
	mission->room = DS1921_LOG_ROOM;
	mission->rollover = page[DS1921_CONTROL] & DS1921_RO;
	mission->stamp[LOGGER_SECONDS] = 0;
	memcpy(mission->stamp + LOGGER_MINUTES, page + DS1921_STAMP, LOGGER_TIME - 1);
	if (mission->stamp[LOGGER_YEAR] < 0x70)
		mission->stamp[LOGGER_MONTH] |= 0x80;
	return 0;
}

static int ds1921_look(struct txn *txn, uint8_t page[LOGGER_PAGE])
{
	return area_fetch(txn, &ds1921_registers, 0, page, LOGGER_PAGE);
}

const struct logger ds1921_logger = {
	.copy = 0x55,
	.weekday = true,
	.status = DS1921_STATUS,
	.running = DS1921_MIP,
	.clock = &ds1921_registers,
	.look = ds1921_look,
	.mission = ds1921_mission,
};

int ds1921_read_log(struct txn *txn)
{
	const struct ds1921_version *version = ds1921_version_of(txn->device);
	uint32_t *index = txn_own(txn, uint32_t);
	struct logger_mission mission;
	uint8_t code;
	int err;

	if (!version)
		return -EMEDIUMTYPE;
	if (txn->phase == 0) {
		err = ds1921_mission(txn, &mission);
		if (err)
			return err;
		if ((uint32_t)txn->element >= logger_elements(&mission))
			return -ENODATA;
		*index = logger_index(&mission, (uint32_t)txn->element);
		txn->phase = 1;
		return TXN_MORE;
	}
	err = area_read(txn, &ds1921_log, *index, &code, 1);
	if (!err)
		txn->number[0] = ds1921_celsius(version, code);
	return err;
}

struct times_visit {
	struct logger_mission mission;
	uint8_t first[DS1921_PAGE];
};

/* Of the times beyond a limit, each a sample's number and how many there were. */
static int take_times(struct txn *txn, const uint8_t *times)
{
	const struct logger_mission *mission = &txn_own(txn, struct times_visit)->mission;
	int what = txn->property->arg & 0xff;
	unsigned used = 0;
	double start = 0;
	int err = 0;

	while (used < DS1921_TIMES && times[4 * used + 3])
		used++;
	if (what == DS1921_TIMES_HOW_MANY) {
		txn->number[0] = used;
		return 0;
	}
	/* of a logger that has logged nothing yet there is no stamp, and no count needs it */
	if (what != DS1921_TIMES_COUNT)
		err = logger_date(mission->stamp, &start);
	for (unsigned i = 0; i < DS1921_TIMES; i++) {
		const uint8_t *entry = times + 4 * i;
		double sample = logger_count(entry, 3) + (what == DS1921_TIMES_END ? entry[3] : 0);

		txn->number[i] = what == DS1921_TIMES_COUNT ? entry[3]
		                                            : start + mission->interval * sample;
	}
	return err;
}

/* The registers, and the two pages on which the times are. */
int ds1921_read_times(struct txn *txn)
{
	struct times_visit *visit = txn_own(txn, struct times_visit);
	unsigned first = (unsigned)txn->property->arg >> 8,
		 head = DS1921_PAGE - first % DS1921_PAGE;
	uint8_t times[4 * DS1921_TIMES];
	int err;

	if (txn->phase < 2) {
		err = txn->phase == 0
		              ? ds1921_mission(txn, &visit->mission)
		              : area_read(txn, &ds1921_registers, first, visit->first, head);
		txn->phase++;
		return err ? err : TXN_MORE;
	}
	memcpy(times, visit->first, head);
	err = area_read(txn, &ds1921_registers, first + head, times + head, sizeof(times) - head);
	return err ? err : take_times(txn, times);
}

int ds1921_read_limit(struct txn *txn)
{
	const struct ds1921_version *version = ds1921_version_of(txn->device);
	uint8_t code = 0;
	int err = area_read(txn, &ds1921_registers, (unsigned)txn->property->arg, &code, 1);

	if (!version)
		return -EMEDIUMTYPE;
	txn->number[0] = ds1921_celsius(version, code);
	return err;
}

/* Of the registers whose bit 7 is set, which is the last? */
int ds1921_read_trigger(struct txn *txn)
{
	uint8_t bytes[4];
	int err = area_read(txn, &ds1921_registers, DS1921_CLOCK_ALARM, bytes, 4);

	txn->number[0] = 0;
	for (unsigned i = 0; i < 4 && !err; i++)
		txn->number[0] = bytes[i] & 0x80 ? i + 1 : txn->number[0];
	return err;
}
