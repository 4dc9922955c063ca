/* SPDX-License-Identifier: MIT */
/*
 * DS1922L, DS1922T, DS1923 and DS2422, loggers of a temperature and a second quantity: areas, what
 * registers mean, clock, missions and logs, and the table.
 */
#include "hal/chips/loggers/ds1922.h"

#include <errno.h>
#include <string.h>

#include "hal/chips/family.h"

/* Address and password, then the bytes to the end of the page with their CRC16. */
int ds1922_load(struct txn *txn, const struct area *area, unsigned at, uint8_t *bytes, unsigned n)
{
	unsigned where = area->at + at;
	uint8_t command[3 + LOGGER_PASSWORD] = {area->read, (uint8_t)where, (uint8_t)(where >> 8)};

	memset(command + 3, 0xff, LOGGER_PASSWORD);
	int err = txn_command(txn, command, sizeof(command));
	return err ? err : txn_read_crc16(txn, command, 3, bytes, n);
}

AREA_NAMED(ds1922_memory, "memory", .size = DS1922_PAGES * DS1922_PAGE, .block = DS1922_PAGE,
           .read = 0x69, .load = ds1922_load);
static AREA_NAMED(ds1922_log, "log", .at = DS1922_LOG, .size = DS1922_LOG_SIZE,
                  .block = DS1922_PAGE, .read = 0x69, .load = ds1922_load);

/* Of the configuration; -1: not known. */
double ds1922_zero_of(uint8_t config)
{
	switch (config) {
	case 0x00: /* DS2422, DS1923, DS1922L */
	case 0x20:
	case 0x40:
		return 41;
	case 0x60: /* DS1922T */
		return 1;
	default:
		return -1;
	}
}

bool ds1922_has_data(uint8_t config)
{
	return config == 0x00 || config == 0x20;
}

/* High and low byte; one without low byte has eight bits. */
double ds1922_celsius(uint8_t config, uint8_t high, uint8_t low)
{
	return high / 2.0 - ds1922_zero_of(config) + low / 512.0;
}

/* As owserver: the sensor of the DS1923, not corrected by its calibration. */
double ds1922_humidity(uint8_t high, uint8_t low)
{
	double volts = (high << 4 | low >> 4) * 5.02 / 4096;

	return (volts - 0.958) / 0.0307;
}

double ds1922_interval_of(const uint8_t *page)
{
	unsigned rate = (page[DS1922_RATE - DS1922_CLOCK] | page[DS1922_RATE + 1 - DS1922_CLOCK]
	                                                            << 8) &
	                DS1922_RATE_MOST;

	return page[DS1922_OSCILLATOR - DS1922_CLOCK] & DS1922_FAST ? rate : 60.0 * rate;
}

struct mission {
	struct logger_mission common;
	uint8_t settings, config;
	unsigned data; /* where samples of the second quantity begin */
};

/* How the samples share the log: one quantity, both alike, or one of them wide. */
static void divide_log(struct mission *mission)
{
	bool wide = mission->settings & DS1922_WIDE,
	     data_wide = mission->settings & DS1922_DATA_WIDE;
	bool both = (mission->settings & (DS1922_LOG_TEMP | DS1922_LOG_DATA)) ==
	            (DS1922_LOG_TEMP | DS1922_LOG_DATA);

	mission->data = 0;
	if (!both) {
		mission->common.room = (mission->settings & DS1922_LOG_TEMP ? wide : data_wide)
		                               ? 4096
		                               : 8192;
		return;
	}
	mission->common.room = wide != data_wide ? 2560 : wide ? 2048 : 4096;
	mission->data = wide == data_wide ? 4096 : wide ? 0x1400 : 0xa00;
}

/* Two pages, one for each call; TXN_MORE until both are read: then the phase is 2. */
static int ds1922_mission(struct txn *txn, struct logger_mission *common)
{
	struct mission *mission = txn_own(txn, struct mission);
	uint8_t page[DS1922_PAGE];
	int err;

	if (txn->phase == 2)
		return 0;
	err = area_read(txn, &ds1922_memory, txn->phase == 0 ? DS1922_CLOCK : DS1922_SAMPLES, page,
	                DS1922_PAGE);
	if (err)
		return err;
	if (txn->phase++ == 0) {
		mission->settings = page[DS1922_MISSION - DS1922_CLOCK];
		common->interval = ds1922_interval_of(page);
		common->rollover = mission->settings & DS1922_RO;
		memcpy(common->stamp, page + (DS1922_STAMP - DS1922_CLOCK), LOGGER_TIME);
		divide_log(mission);
	} else {
		common->samples = logger_count(page, 3);
		mission->config = page[DS1922_CONFIG - DS1922_SAMPLES];
	}
	return TXN_MORE;
}

static int ds1922_look(struct txn *txn, uint8_t page[LOGGER_PAGE])
{
	return ds1922_load(txn, &ds1922_memory, DS1922_CLOCK, page, LOGGER_PAGE);
}

const struct logger ds1922_logger = {
	.copy = 0x99,
	.password = true,
	.status = DS1922_STATUS - DS1922_CLOCK,
	.running = DS1922_MIP,
	.clock = &ds1922_memory,
	.look = ds1922_look,
	.mission = ds1922_mission,
};

/* A sample of one quantity; arg: LOG_TEMP or LOG_DATA. */
static int ds1922_read_log(struct txn *txn)
{
	struct mission *mission = txn_own(txn, struct mission);
	bool data = txn->property->arg == DS1922_LOG_DATA;
	uint8_t bytes[2] = {0};
	int err = ds1922_mission(txn, &mission->common);

	if (err)
		return err;
	unsigned size = mission->settings & (data ? DS1922_DATA_WIDE : DS1922_WIDE) ? 2 : 1;
	uint32_t n = (uint32_t)txn->element;
	if (!(mission->settings & txn->property->arg) || n >= logger_elements(&mission->common) ||
	    ds1922_zero_of(mission->config) < 0)
		return -ENODATA;
	err = area_read(txn, &ds1922_log,
	                (data ? mission->data : 0) + size * logger_index(&mission->common, n),
	                bytes, size);
	if (!err)
		txn->number[0] = data ? ds1922_humidity(bytes[0], bytes[1])
		                      : ds1922_celsius(mission->config, bytes[0], bytes[1]);
	return err;
}

static int ds1922_read_interval(struct txn *txn)
{
	uint8_t page[DS1922_PAGE];
	int err = area_read(txn, &ds1922_memory, DS1922_CLOCK, page, DS1922_PAGE);

	if (!err)
		txn->number[0] = ds1922_interval_of(page);
	return err;
}

/* --- The table --- */

enum { MEMORY = 1 };
static const struct area *const areas[] = {[MEMORY] = &ds1922_memory};

#define WAYS(X) \
	X(CLOCK, .read = logger_read_clock, .write = ds1922_write_clock) \
	X(STAMP, .read = logger_read_date) \
	X(FIELD, .write = logger_write_field) \
	X(RUNNING, .write = ds1922_write_running) \
	X(INTERVAL, .read = ds1922_read_interval, .write = ds1922_write_interval) \
	X(ELEMENTS, .read = logger_read_elements) \
	X(LOG, .read = ds1922_read_log) \
	X(NOW, .read = ds1922_read_now) \
	X(PAGE, .write = ds1922_write_page)
enum { WAY_NONE, WAYS(WAY_ENUM) };
static const struct property_how how[] = {WAYS(WAY_HOW)};

#define BIT(text, life, access, where, shift_, way) \
	PROPERTY(text, YESNO, life, access, .how = (way), \
	         FIELD(MEMORY, .at = (where), .shift = (shift_), .bits = 1))
/* What owserver does not have: hidden. */
#define OWN(text, type, access, ...) \
	PROPERTY(text, type, VOLATILE, access, .hidden = true, __VA_ARGS__)
#define SAMPLES_OF(text, type, way, what, ...) \
	OWN(text, type, READ, ELEMENTS(DS1922_LOG_SIZE, NUMBERS), .how = (way), .arg = (what), \
	    __VA_ARGS__)

/* 0 to 100 %RH within 5, and as much again for its ageing in wet air */
#define PERCENT MEASURES(-10, 110, 2, "%")
/* L: -40 to +85, T to +125, E to +140, within 2; 0.0625 */
#define CELSIUS MEASURES(-42, 142, 4, DEGREES_C)

static const struct property properties[] = {
	PROPERTY_DIR("clock"),
	PROPERTY("clock/date", DATE, SECOND, BOTH, .how = WAY_CLOCK),
	BIT("clock/running", STABLE, BOTH, DS1922_OSCILLATOR, 0, WAY_FIELD),
	PROPERTY("clock/udate", UNSIGNED, SECOND, BOTH, .how = WAY_CLOCK),
	PROPERTY("humidity", FLOAT, VOLATILE, READ, PERCENT, .how = WAY_NOW,
                 .arg = DS1922_LOG_DATA),
	OWN("log/elements", UNSIGNED, READ, .how = WAY_ELEMENTS),
	SAMPLES_OF("log/humidity", FLOAT, WAY_LOG, DS1922_LOG_DATA, PERCENT),
	SAMPLES_OF("log/temperature", TEMPERATURE, WAY_LOG, DS1922_LOG_TEMP, CELSIUS),
	SAMPLES_OF("log/udate", UNSIGNED, WAY_STAMP, 1, .size = 0),
	PROPERTY_DIR("mission"),
	PROPERTY("mission/delay", UNSIGNED, VOLATILE, BOTH, .how = WAY_FIELD,
                 FIELD(MEMORY, .at = DS1922_DELAY, .bytes = 3)),
	OWN("mission/interval", UNSIGNED, BOTH, .how = WAY_INTERVAL),
	BIT("mission/rollover", STABLE, BOTH, DS1922_MISSION, 4, WAY_FIELD),
	BIT("mission/running", VOLATILE, BOTH, DS1922_STATUS, 1, WAY_RUNNING),
	OWN("mission/samples", UNSIGNED, READ, COUNTS_TO(0xffffff),
            FIELD(MEMORY, .at = DS1922_SAMPLES, .bytes = 3)),
	BIT("mission/samplinghumidity", VOLATILE, READ, DS1922_MISSION, 1, 0),
	BIT("mission/samplingtemp", VOLATILE, READ, DS1922_MISSION, 0, 0),
	OWN("mission/udate", UNSIGNED, READ, .how = WAY_STAMP),
	PROPERTY_DIR("pages"),
	PROPERTY("pages/page", BINARY, VOLATILE, BOTH, ELEMENTS(DS1922_PAGES, NUMBERS),
                 .size = DS1922_PAGE, .how = WAY_PAGE, FIELD(MEMORY)),
	PROPERTY("temperature", TEMPERATURE, VOLATILE, READ, CELSIUS, .how = WAY_NOW,
                 .arg = DS1922_LOG_TEMP),
};

CHIP_FAMILY(41, "DS1923", CHECKSUM, .alarms = true,
            .flags = FLAG_RESUME | FLAG_ALARM | FLAG_OVERDRIVE | FLAG_TEMPERATURE,
            .facts = &ds1922_logger, SCAN({"temperature", "temperature"}, {"humidity", "humidity"}),
            AREAS(areas), HOW(how), PROPERTIES(properties));
