/* SPDX-License-Identifier: MIT */
/* DS1922L, DS1922T, DS1923 and DS2422: loggers of a temperature and a second quantity. */
#include "hal/chips/family.h"
#include "hal/chips/loggers/ds1922.h"

enum { MEMORY = 1 };
static const struct area *const areas[] = {[MEMORY] = &ds1922_memory};

enum {
	WAY_DATE = 1,
	WAY_UDATE,
	WAY_STAMP,
	WAY_FIELD,
	WAY_RUNNING,
	WAY_INTERVAL,
	WAY_ELEMENTS,
	WAY_LOG,
	WAY_NOW,
	WAY_PAGE,
};
static const struct property_how how[] = {
	[WAY_DATE] = {.read = logger_read_clock, .write = ds1922_write_date},
	[WAY_UDATE] = {.read = logger_read_clock, .write = ds1922_write_udate},
	[WAY_STAMP] = {.read = logger_read_date},
	[WAY_FIELD] = {.write = logger_write_field},
	[WAY_RUNNING] = {.write = ds1922_write_running},
	[WAY_INTERVAL] = {.read = ds1922_read_interval, .write = ds1922_write_interval},
	[WAY_ELEMENTS] = {.read = logger_read_elements},
	[WAY_LOG] = {.read = ds1922_read_log},
	[WAY_NOW] = {.read = ds1922_read_now},
	[WAY_PAGE] = {.write = ds1922_write_page},
};

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
	PROPERTY("clock/date", DATE, SECOND, BOTH, .how = WAY_DATE),
	BIT("clock/running", STABLE, BOTH, DS1922_OSCILLATOR, 0, WAY_FIELD),
	PROPERTY("clock/udate", UNSIGNED, SECOND, BOTH, .how = WAY_UDATE),
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
