/* SPDX-License-Identifier: MIT */
/* DS1921G, L, H and Z: thermometers with a clock that log a mission. */
#include "hal/chips/family.h"
#include "hal/chips/loggers/ds1921.h"

enum { MEMORY = 1, REGISTERS, HISTOGRAM, LOG };
static const struct area *const areas[] = {[MEMORY] = &ds1921_memory,
                                           [REGISTERS] = &ds1921_registers,
                                           [HISTOGRAM] = &ds1921_histogram,
                                           [LOG] = &ds1921_log};

enum {
	WAY_VERSION = 1,
	WAY_BINS,
	WAY_DATE,
	WAY_UDATE,
	WAY_FIELD,
	WAY_STATUS,
	WAY_FLAG,
	WAY_ELEMENTS,
	WAY_LOG,
	WAY_STAMP,
	WAY_TIMES,
	WAY_LIMIT,
	WAY_TRIGGER,
	WAY_TEMPERATURE,
	WAY_CLEAR,
	WAY_FREQUENCY,
	WAY_RUNNING,
	WAY_EASYSTART,
};
static const struct property_how how[] = {
	[WAY_VERSION] = {.read = ds1921_read_version},
	[WAY_BINS] = {.read = ds1921_read_bins},
	[WAY_DATE] = {.read = logger_read_clock, .write = ds1921_write_date},
	[WAY_UDATE] = {.read = logger_read_clock, .write = ds1921_write_udate},
	[WAY_FIELD] = {.write = logger_write_field},
	[WAY_STATUS] = {.write = ds1921_write_status},
	[WAY_FLAG] = {.write = ds1921_write_flag},
	[WAY_ELEMENTS] = {.read = logger_read_elements},
	[WAY_LOG] = {.read = ds1921_read_log},
	[WAY_STAMP] = {.read = logger_read_date},
	[WAY_TIMES] = {.read = ds1921_read_times},
	[WAY_LIMIT] = {.read = ds1921_read_limit, .write = ds1921_write_limit},
	[WAY_TRIGGER] = {.read = ds1921_read_trigger, .write = ds1921_write_trigger},
	[WAY_TEMPERATURE] = {.read = ds1921_read_temperature},
	[WAY_CLEAR] = {.write = ds1921_clear_memory},
	[WAY_FREQUENCY] = {.write = ds1921_write_frequency},
	[WAY_RUNNING] = {.write = ds1921_write_running},
	[WAY_EASYSTART] = {.write = ds1921_write_easystart},
};

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
	PROPERTY("clock/date", DATE, SECOND, BOTH, .how = WAY_DATE),
	PROPERTY("clock/running", YESNO, VOLATILE, BOTH, .how = WAY_FIELD,
                 FIELD(REGISTERS, .at = DS1921_CONTROL, .shift = 7, .bits = 1, .inverted = true)),
	PROPERTY("clock/udate", UNSIGNED, SECOND, BOTH, .how = WAY_UDATE),
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
