/* SPDX-License-Identifier: MIT */
/*
 * DS1921G, L, H and Z, thermometers with a clock that log a mission: areas, versions, what is read
 * (clock, missions, logs, the times beyond a limit), and the table.
 */
#include "hal/chips/loggers/ds1921.h"

#include <errno.h>
#include <string.h>

#include "hal/chips/family.h"

/* arg of what is read of the version. */
enum { DS1921_RESOLUTION, DS1921_LEAST, DS1921_MOST, DS1921_GAP, DS1921_BIN, DS1921_NAME };

/* arg of the times beyond a limit: where they begin, and what of them. */
enum { DS1921_TIMES_COUNT, DS1921_TIMES_BEGIN, DS1921_TIMES_END, DS1921_TIMES_HOW_MANY };
#define DS1921_TIMES_ARG(first, what) ((first) << 8 | (what))

#define CHECKED .address_bytes = 2, .read = 0xa5, .block = DS1921_PAGE, .check = AREA_CRC16

static AREA_NAMED(ds1921_memory, "memory", .size = 512, CHECKED, .row = DS1921_PAGE, .write = 0x0f,
                  .verify = 0xaa, .copy = 0x55, .write_crc16 = true, .copy_ns = TXN_MS);
static AREA_NAMED(ds1921_registers, "registers", .at = LOGGER_REGISTERS,
                  .size = DS1921_REGISTERS_END, CHECKED);
static AREA_NAMED(ds1921_histogram, "histogram", .at = 0x800, .size = 128, CHECKED);
static AREA_NAMED(ds1921_log, "log", .at = 0x1000, .size = DS1921_LOG_ROOM, CHECKED);

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
static int ds1921_read_version(struct txn *txn)
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

static int ds1921_read_bins(struct txn *txn)
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

static int ds1921_read_log(struct txn *txn)
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
static int ds1921_read_times(struct txn *txn)
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

static int ds1921_read_limit(struct txn *txn)
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
static int ds1921_read_trigger(struct txn *txn)
{
	uint8_t bytes[4];
	int err = area_read(txn, &ds1921_registers, DS1921_CLOCK_ALARM, bytes, 4);

	txn->number[0] = 0;
	for (unsigned i = 0; i < 4 && !err; i++)
		txn->number[0] = bytes[i] & 0x80 ? i + 1 : txn->number[0];
	return err;
}

/* --- The table --- */

enum { MEMORY = 1, REGISTERS, HISTOGRAM, LOG };
static const struct area *const areas[] = {[MEMORY] = &ds1921_memory,
                                           [REGISTERS] = &ds1921_registers,
                                           [HISTOGRAM] = &ds1921_histogram,
                                           [LOG] = &ds1921_log};

#define WAYS(X) \
	X(VERSION, .read = ds1921_read_version) \
	X(BINS, .read = ds1921_read_bins) \
	X(CLOCK, .read = logger_read_clock, .write = ds1921_write_clock) \
	X(FIELD, .write = logger_write_field) \
	X(STATUS, .write = ds1921_write_status) \
	X(FLAG, .write = ds1921_write_flag) \
	X(ELEMENTS, .read = logger_read_elements) \
	X(LOG, .read = ds1921_read_log) \
	X(STAMP, .read = logger_read_date) \
	X(TIMES, .read = ds1921_read_times) \
	X(LIMIT, .read = ds1921_read_limit, .write = ds1921_write_limit) \
	X(TRIGGER, .read = ds1921_read_trigger, .write = ds1921_write_trigger) \
	X(TEMPERATURE, .read = ds1921_read_temperature) \
	X(CLEAR, .write = ds1921_clear_memory) \
	X(FREQUENCY, .write = ds1921_write_frequency) \
	X(RUNNING, .write = ds1921_write_running) \
	X(EASYSTART, .write = ds1921_write_easystart)
enum { WAY_NONE, WAYS(WAY_ENUM) };
static const struct property_how how[] = {WAYS(WAY_HOW)};

#define VERSION(text, type, what) \
	PROPERTY(text, type, STATIC, READ, .offline = true, .arg = (what), .how = WAY_VERSION)
#define BIT(text, access, where, shift_, ...) \
	PROPERTY(text, YESNO, VOLATILE, access, __VA_ARGS__, \
	         FIELD(REGISTERS, .at = (where), .shift = (shift_), .bits = 1))
#define MISSION_FLAG .how = WAY_FLAG, .alarm = ALARM_LATCH | ALARM_STAYS | ALARM_CLEARS
#define COUNT(text, where, n, ...) \
	PROPERTY(text, UNSIGNED, VOLATILE, __VA_ARGS__, \
	         FIELD(REGISTERS, .at = (where), .bytes = (n)))
#define ALARM(text, where) \
	PROPERTY(text, UNSIGNED, STABLE, BOTH, .how = WAY_FIELD, \
	         FIELD(REGISTERS, .at = (where), .bits = 7))
#define EACH_TIME(text, type, first, what, ...) \
	PROPERTY(text, type, VOLATILE, READ, AGGREGATE(DS1921_TIMES, NUMBERS), .how = WAY_TIMES, \
	         .arg = DS1921_TIMES_ARG(first, what), __VA_ARGS__)
#define RATE_OF(text, life) \
	PROPERTY(text, UNSIGNED, life, BOTH, .how = WAY_FREQUENCY, \
	         FIELD(REGISTERS, .at = DS1921_RATE))
/* clang-format off */
#define TIMES_BEYOND(name_, first, limit) \
	PROPERTY_DIR(name_), \
	EACH_TIME(name_ "/count", UNSIGNED, first, DS1921_TIMES_COUNT, COUNTS_TO(UINT8_MAX)), \
	EACH_TIME(name_ "/date", DATE, first, DS1921_TIMES_BEGIN, .size = 0), \
	PROPERTY(name_ "/elements", UNSIGNED, VOLATILE, READ, .how = WAY_TIMES, \
	         .arg = DS1921_TIMES_ARG(first, DS1921_TIMES_HOW_MANY)), \
	EACH_TIME(name_ "/end", DATE, first, DS1921_TIMES_END, .size = 0), \
	PROPERTY(name_ "/temperature", TEMPERATURE, STABLE, BOTH, .arg = (limit), \
	         .how = WAY_LIMIT), \
	EACH_TIME(name_ "/udate", UNSIGNED, first, DS1921_TIMES_BEGIN, .size = 0)
/* clang-format on */

/* G: -40 to +85 within 1.3, 0.5; H and Z 0.125 */
#define CELSIUS MEASURES(-42, 87, 3, DEGREES_C)

static const struct property properties[] = {
	PROPERTY("ControlRegister", UNSIGNED, STABLE, BOTH, .hidden = true, .how = WAY_FIELD,
                 FIELD(REGISTERS, .at = DS1921_CONTROL)),
	PROPERTY("StatusRegister", UNSIGNED, STABLE, BOTH, .hidden = true, .how = WAY_STATUS,
                 FIELD(REGISTERS, .at = DS1921_STATUS)),
	PROPERTY_DIR("about"),
	PROPERTY("about/measuring", YESNO, VOLATILE, READ,
                 FIELD(REGISTERS, .at = DS1921_STATUS, .shift = 7, .bits = 1, .inverted = true)),
	VERSION("about/resolution", TEMPGAP, DS1921_RESOLUTION),
	COUNT("about/samples", DS1921_DEVICE_SAMPLES, 3, READ, COUNTS_TO(0xffffff)),
	VERSION("about/temphigh", TEMPERATURE, DS1921_MOST),
	VERSION("about/templow", TEMPERATURE, DS1921_LEAST),
	PROPERTY("about/version", ASCII, STABLE, READ, .offline = true, .arg = DS1921_NAME,
                 .size = 11, .how = WAY_VERSION),
	ALARM("alarm_dow", DS1921_CLOCK_ALARM + 3),
	ALARM("alarm_hour", DS1921_CLOCK_ALARM + 2),
	ALARM("alarm_minute", DS1921_CLOCK_ALARM + 1),
	ALARM("alarm_second", DS1921_CLOCK_ALARM),
	RATE_OF("alarm_state", STABLE),
	PROPERTY("alarm_trigger", UNSIGNED, STABLE, BOTH, .how = WAY_TRIGGER),
	PROPERTY_DIR("clock"),
	PROPERTY("clock/date", DATE, SECOND, BOTH, .how = WAY_CLOCK),
	PROPERTY("clock/running", YESNO, VOLATILE, BOTH, .how = WAY_FIELD,
                 FIELD(REGISTERS, .at = DS1921_CONTROL, .shift = 7, .bits = 1, .inverted = true)),
	PROPERTY("clock/udate", UNSIGNED, SECOND, BOTH, .how = WAY_CLOCK),
	PROPERTY_DIR("histogram"),
	PROPERTY("histogram/counts", UNSIGNED, VOLATILE, READ, ELEMENTS(DS1921_BINS, NUMBERS),
                 FIELD(HISTOGRAM, .stride = 2, .bytes = 2), COUNTS_TO(UINT16_MAX)),
	PROPERTY("histogram/elements", UNSIGNED, STATIC, READ, .offline = true, .how = WAY_BINS),
	VERSION("histogram/gap", TEMPGAP, DS1921_GAP),
	PROPERTY("histogram/temperature", TEMPERATURE, STATIC, READ, ELEMENTS(DS1921_BINS, NUMBERS),
                 .offline = true, .arg = DS1921_BIN, .how = WAY_VERSION),
	PROPERTY_DIR("log"),
	PROPERTY("log/date", DATE, VOLATILE, READ, ELEMENTS(DS1921_LOG_ROOM, NUMBERS),
                 .how = WAY_STAMP, .arg = 1),
	PROPERTY("log/elements", UNSIGNED, VOLATILE, READ, .how = WAY_ELEMENTS),
	PROPERTY("log/temperature", TEMPERATURE, VOLATILE, READ, ELEMENTS(DS1921_LOG_ROOM, NUMBERS),
                 CELSIUS, .how = WAY_LOG),
	PROPERTY("log/udate", UNSIGNED, VOLATILE, READ, ELEMENTS(DS1921_LOG_ROOM, NUMBERS),
                 .how = WAY_STAMP, .arg = 1),
	AREA_MEMORY(MEMORY, 512),
	PROPERTY_DIR("mission"),
	PROPERTY("mission/clear", YESNO, VOLATILE, WRITE, .how = WAY_CLEAR),
	PROPERTY("mission/date", DATE, VOLATILE, READ, .how = WAY_STAMP),
	COUNT("mission/delay", DS1921_DELAY, 2, BOTH, .how = WAY_FIELD),
	PROPERTY("mission/easystart", UNSIGNED, STABLE, WRITE, .how = WAY_EASYSTART),
	PROPERTY("mission/enable", YESNO, VOLATILE, BOTH, .how = WAY_FIELD,
                 FIELD(REGISTERS, .at = DS1921_CONTROL, .shift = 4, .bits = 1, .inverted = true)),
	RATE_OF("mission/frequency", VOLATILE),
	BIT("mission/rollover", BOTH, DS1921_CONTROL, 3, .how = WAY_FIELD),
	BIT("mission/running", BOTH, DS1921_STATUS, 5, .how = WAY_RUNNING),
	COUNT("mission/samples", DS1921_SAMPLES, 3, READ, COUNTS_TO(0xffffff)),
	BIT("mission/sampling", READ, DS1921_STATUS, 4, .how = 0),
	BIT("mission/temphigh", BOTH, DS1921_STATUS, 1, MISSION_FLAG),
	BIT("mission/templow", BOTH, DS1921_STATUS, 2, MISSION_FLAG),
	BIT("mission/timer", BOTH, DS1921_STATUS, 0, MISSION_FLAG, .hidden = true),
	PROPERTY("mission/udate", UNSIGNED, VOLATILE, READ, .how = WAY_STAMP),
	TIMES_BEYOND("overtemp", DS1921_HIGH_TIMES, DS1921_HIGH),
	PROPERTY_DIR("pages"),
	AREA_PAGES(MEMORY, 16, 32),
	PROPERTY_DIR("set_alarm"),
	BIT("set_alarm/date", BOTH, DS1921_CONTROL, 0, .how = WAY_FIELD),
	BIT("set_alarm/temphigh", BOTH, DS1921_CONTROL, 1, .how = WAY_FIELD),
	BIT("set_alarm/templow", BOTH, DS1921_CONTROL, 2, .how = WAY_FIELD),
	PROPERTY("set_alarm/trigger", YESNO, VOLATILE, NONE, .how = 0),
	PROPERTY("temperature", TEMPERATURE, VOLATILE, READ, CELSIUS, .how = WAY_TEMPERATURE),
	TIMES_BEYOND("undertemp", DS1921_LOW_TIMES, DS1921_LOW),
};

CHIP_FAMILY(21, "DS1921", PRESENCE, .alarms = true,
            .flags = FLAG_ALARM | FLAG_OVERDRIVE | FLAG_TEMPERATURE, .facts = &ds1921_logger,
            SCAN({"temperature", "temperature"}), AREAS(areas), HOW(how), PROPERTIES(properties));
