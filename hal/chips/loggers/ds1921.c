/* SPDX-License-Identifier: MIT */
/* DS1921: areas, versions, and what is read: clock, missions, logs, the times beyond a limit. */
#include "hal/chips/loggers/ds1921.h"

#include <errno.h>
#include <string.h>

#include "hal/chips/family.h"
#include "hal/chips/loggers/logger.h"

#define CHECKED .address_bytes = 2, .read = 0xa5, .block = DS1921_PAGE, .check = AREA_CRC16

const struct area ds1921_memory = {
	.name = "memory",
	.size = 512,
	CHECKED,
	.row = DS1921_PAGE,
	.write = 0x0f,
	.verify = 0xaa,
	.copy = 0x55,
	.write_crc16 = true,
	.copy_ns = TXN_MS,
};
const struct area ds1921_registers = {
	.name = "registers", .at = DS1921_REGISTERS, .size = DS1921_REGISTERS_END, CHECKED};
const struct area ds1921_histogram = {.name = "histogram", .at = 0x800, .size = 128, CHECKED};
const struct area ds1921_log = {.name = "log", .at = 0x1000, .size = DS1921_LOG_ROOM, CHECKED};

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
		return -EIO;
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

int ds1921_read_clock(struct txn *txn)
{
	uint8_t bytes[DS1921_CLOCK_ALARM];
	int err = area_read(txn, &ds1921_registers, DS1921_CLOCK, bytes, sizeof(bytes));

	if (err)
		return err;
	memmove(bytes + DS1921_WEEKDAY, bytes + DS1921_WEEKDAY + 1, 3);
	return logger_date(bytes, &txn->number[0]);
}

struct mission {
	struct logger_log log;
	double start, interval;
};

/* The stamp has no seconds, and its month may be without a century. */
static int take_stamp(const uint8_t *stamp, double *start)
{
	uint8_t bcd[LOGGER_TIME] = {0};

	memcpy(bcd + LOGGER_MINUTES, stamp, 5);
	if (bcd[LOGGER_YEAR] < 0x70)
		bcd[LOGGER_MONTH] |= 0x80;
	return logger_date(bcd, start);
}

/* dates: of a logger that has logged nothing yet there is no stamp. */
static int read_mission(struct txn *txn, struct mission *mission, bool dates)
{
	uint8_t page[DS1921_PAGE];
	int err = area_read(txn, &ds1921_registers, 0, page, DS1921_PAGE);

	if (err)
		return err;
	mission->interval = 60 * page[DS1921_RATE];
	mission->log.samples = logger_count(page + DS1921_SAMPLES, 3);
	mission->log.room = DS1921_LOG_ROOM;
	mission->log.rollover = page[DS1921_CONTROL] & DS1921_RO;
	return dates ? take_stamp(page + DS1921_STAMP, &mission->start) : 0;
}

int ds1921_read_start(struct txn *txn)
{
	struct mission mission = {0};
	int err = read_mission(txn, &mission, true);

	txn->number[0] = mission.start;
	return err;
}

int ds1921_read_elements(struct txn *txn)
{
	struct mission mission = {0};
	int err = read_mission(txn, &mission, false);

	txn->number[0] = logger_elements(&mission.log);
	return err;
}

int ds1921_read_log_date(struct txn *txn)
{
	struct mission mission = {0};
	int err = read_mission(txn, &mission, true);

	if (err)
		return err;
	if ((uint32_t)txn->element >= logger_elements(&mission.log))
		return -EIO;
	txn->number[0] = mission.start +
	                 mission.interval * logger_sample(&mission.log, (uint32_t)txn->element);
	return 0;
}

int ds1921_read_log(struct txn *txn)
{
	const struct ds1921_version *version = ds1921_version_of(txn->device);
	uint32_t *place = txn_own(txn, uint32_t);
	struct mission mission = {0};
	uint8_t code;
	int err;

	if (!version)
		return -EIO;
	if (txn->phase == 0) {
		err = read_mission(txn, &mission, false);
		if (err)
			return err;
		if ((uint32_t)txn->element >= logger_elements(&mission.log))
			return -EIO;
		*place = logger_place(&mission.log, (uint32_t)txn->element);
		txn->phase = 1;
		return TXN_MORE;
	}
	err = area_read(txn, &ds1921_log, *place, &code, 1);
	if (!err)
		txn->number[0] = ds1921_celsius(version, code);
	return err;
}

/* Of the times beyond a limit, each a sample's number and how many there were. */
static void take_times(struct txn *txn, const uint8_t *times, const struct mission *mission)
{
	int what = txn->property->arg & 0xff;
	unsigned used = 0;

	while (used < DS1921_TIMES && times[4 * used + 3])
		used++;
	for (unsigned i = 0; i < DS1921_TIMES && what != DS1921_TIMES_HOW_MANY; i++) {
		const uint8_t *entry = times + 4 * i;
		double sample = logger_count(entry, 3) + (what == DS1921_TIMES_END ? entry[3] : 0);

		txn->number[i] = what == DS1921_TIMES_COUNT
		                         ? entry[3]
		                         : mission->start + mission->interval * sample;
	}
	if (what == DS1921_TIMES_HOW_MANY)
		txn->number[0] = used;
}

struct times_visit {
	struct mission mission;
	uint8_t first[DS1921_PAGE];
};

/* The registers, and the two pages on which the times are. */
int ds1921_read_times(struct txn *txn)
{
	struct times_visit *visit = txn_own(txn, struct times_visit);
	int what = txn->property->arg & 0xff;
	unsigned first = (unsigned)txn->property->arg >> 8,
		 head = DS1921_PAGE - first % DS1921_PAGE;
	uint8_t times[4 * DS1921_TIMES];
	int err;

	if (txn->phase < 2) {
		err = txn->phase == 0
		              ? read_mission(txn, &visit->mission,
		                             what == DS1921_TIMES_BEGIN || what == DS1921_TIMES_END)
		              : area_read(txn, &ds1921_registers, first, visit->first, head);
		txn->phase++;
		return err ? err : TXN_MORE;
	}
	memcpy(times, visit->first, head);
	err = area_read(txn, &ds1921_registers, first + head, times + head, sizeof(times) - head);
	if (!err)
		take_times(txn, times, &visit->mission);
	return err;
}

int ds1921_read_limit(struct txn *txn)
{
	const struct ds1921_version *version = ds1921_version_of(txn->device);
	uint8_t code = 0;
	int err = area_read(txn, &ds1921_registers, (unsigned)txn->property->arg, &code, 1);

	if (!version)
		return -EIO;
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
