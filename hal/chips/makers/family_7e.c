/* SPDX-License-Identifier: MIT */
/*
 * Sensors of Embedded Data Systems, EDS0064 to EDS0090: the table of their properties. Their areas
 * and ways are in eds.c, which also says where the facts are from.
 */
#include "hal/chips/family.h"
#include "hal/chips/makers/eds.h"

enum { MEMORY = 1, SWITCHES };
static const struct area *const areas[] = {[MEMORY] = &eds_memory, [SWITCHES] = &eds_switches};

enum { WAY_TAG = 1, WAY_TYPE, WAY_MEMORY, WAY_PAIRS, WAY_STATE, WAY_RESET, WAY_CLEAR };
static const struct property_how how[] = {
	[WAY_TAG] = {.read = eds_read_tag},
	[WAY_TYPE] = {.read = eds_read_type},
	[WAY_MEMORY] = {.write = eds_write_memory},
	[WAY_PAIRS] = {.read = eds_read_pairs, .write = eds_write_pairs},
	[WAY_STATE] = {.write = eds_write_state},
	[WAY_RESET] = {.write = eds_write_reset},
	[WAY_CLEAR] = {.write = eds_write_clear},
};

/* clang-format off */
/* A property of the kind k: OF(64, "temperature", ...) is EDS0064/temperature. */
#define OF(k, name, ...) PROPERTY("EDS00" #k "/" name, __VA_ARGS__, .kinds = KIND(EDS00##k))
#define DIRECTORY_OF(k, name) OF(k, name, DIRECTORY, STATIC, NONE)
#define MEASURED(k, name, type, range, ...) \
	OF(k, name, type, VOLATILE, READ, range, FIELD(MEMORY, __VA_ARGS__))
#define SETTING(k, name, type, ...) OF(k, name, type, VOLATILE, BOTH, FIELD(MEMORY, __VA_ARGS__))
#define LIMIT(k, name, type, unit_, ...) \
	OF(k, "threshold/" name, type, STABLE, BOTH, IN_UNIT(unit_), FIELD(MEMORY, __VA_ARGS__))
#define HIDDEN(k, name, access, where, n, ...) \
	OF(k, name, UNSIGNED, VOLATILE, access, FIELD(where, .bytes = (n), __VA_ARGS__), \
	   .hidden = true)

#define STATE(k, n, where) \
	OF(k, "alarm/state", UNSIGNED, VOLATILE, READ, FIELD(MEMORY, .bytes = (n), .at = (where)), \
	   .hidden = true, .alarm = ALARM_LATCH | ALARM_STAYS)

/* Alarm flags, and what enables them: two bits of one or two bytes, or two of each channel. */
#define FLAG(k, name, where, n, bit) \
	OF(k, name, YESNO, VOLATILE, READ, \
	   FIELD(MEMORY, .at = (where), .bytes = (n), .shift = (bit), .bits = 1), .flag = true, \
	   .alarm = ALARM_LATCH | ALARM_STAYS)
#define FLAGS(k, name, where, n, bit) \
	FLAG(k, "alarm/" name "_hi", where, n, bit), \
	FLAG(k, "alarm/" name "_low", where, n, (bit) + 1)
#define ENABLES(k, name, n, bit) \
	SETTING(k, "set_alarm/" name "_hi", YESNO, .at = 0x40, .bytes = (n), .shift = (bit), \
		.bits = 1), \
	SETTING(k, "set_alarm/" name "_low", YESNO, .at = 0x40, .bytes = (n), .shift = (bit) + 1, \
		.bits = 1)
#define PAIRS(k, name, access, channels, ...) \
	OF(k, name, BITS, VOLATILE, access, AGGREGATE(channels, NUMBERS), FIELD(__VA_ARGS__), \
	   .how = WAY_PAIRS, .flag = ACCESS_##access == ACCESS_READ, \
	   .alarm = ACCESS_##access == ACCESS_READ ? ALARM_LATCH | ALARM_STAYS : 0)

/* What all have. at: of the function of relay and LED, behind which their state stands. */
#define HEAD(k, where, at_) \
	PROPERTY("EDS00" #k, DIRECTORY, STATIC, NONE, .kinds = KIND(EDS00##k)), \
	DIRECTORY_OF(k, "LED"), \
	OF(k, "LED/control", UNSIGNED, VOLATILE, BOTH, \
	   FIELD(where, .at = (at_), .shift = 2, .bits = 2)), \
	OF(k, "LED/state", YESNO, VOLATILE, BOTH, \
	   FIELD(where, .at = (at_) + 1, .shift = 1, .bits = 1), .how = WAY_STATE), \
	DIRECTORY_OF(k, "alarm")
#define CLEAR(k) \
	OF(k, "alarm/clear", YESNO, STABLE, WRITE, .alarm = ALARM_CLEARS, .how = WAY_CLEAR)
#define SECONDS(k, where) \
	OF(k, "counter/seconds", UNSIGNED, SECOND, READ, MEASURES(0, UINT32_MAX, 0, "s"), \
	   FIELD(MEMORY, .at = (where), .bytes = 4))
#define RELAY(k, where, at_) \
	DIRECTORY_OF(k, "relay"), \
	OF(k, "relay/control", UNSIGNED, VOLATILE, BOTH, FIELD(where, .at = (at_), .bits = 2)), \
	OF(k, "relay/state", YESNO, VOLATILE, BOTH, FIELD(where, .at = (at_) + 1, .bits = 1), \
	   .how = WAY_STATE), \
	HIDDEN(k, "relay_function", BOTH, where, 1, .at = (at_)), \
	OF(k, "relay_state", UNSIGNED, VOLATILE, BOTH, FIELD(where, .at = (at_) + 1), \
	   .how = WAY_STATE, .hidden = true)

/* EDS0064 to EDS0068: HAS(...) or NOT(...) water, air, light. */
#define HAS(...) __VA_ARGS__,
#define NOT(...)
/*
 * Semiconductors, also those for pressure: as widely as any of them measures. What air feels like
 * is computed of it: in a freezer with 1 % of humidity it dews at -76 degrees. A platinum resistor:
 * -200 to 850 degrees; its resistance as the register holds it.
 */
#define CELSIUS MEASURES(-58, 128, 4, DEGREES_C)
#define DEW_POINT MEASURES(-110, 128, 4, DEGREES_C)
#define FELT(unit_) MEASURES(-110, HUGE_VAL, 4, unit_)
#define WORD COUNTS_TO(UINT16_MAX)
#define OHM "\u03a9"
#define SIXTEENTHS .bytes = 2, .is_signed = true, .unit = 1 / 16.0
#define FINE .bytes = 3, .is_signed = true, .unit = 1 / 2048.0
#define BYTES(k, name, type, unit_, where) \
	LIMIT(k, name "_hi", type, unit_, .at = (where), .is_signed = true), \
	LIMIT(k, name "_low", type, unit_, .at = (where) + 1, .is_signed = true)
#define FINES(k, name, type, unit_, where) \
	LIMIT(k, name "_hi", type, unit_, .at = (where), FINE), \
	LIMIT(k, name "_low", type, unit_, .at = (where) + 3, FINE)
#define ENVIRONMENT(k, water, air, light) \
	HEAD(k, MEMORY, 0x5e), CLEAR(k), \
	water(FLAGS(k, "dew_point", 0x3a, 2, 4), FLAGS(k, "heat_index", 0x3a, 2, 8), \
	      FLAGS(k, "humidex", 0x3a, 2, 6), FLAGS(k, "humidity", 0x3a, 2, 2)) \
	air(FLAGS(k, "inHg", 0x3a, 2, 12)) light(FLAGS(k, "light", 0x3a, 2, 14)) \
	air(FLAGS(k, "pressure", 0x3a, 2, 10)) \
	STATE(k, 2, 0x3a), \
	FLAGS(k, "temp", 0x3a, 2, 0), DIRECTORY_OF(k, "counter"), SECONDS(k, 0x3c), \
	water(MEASURED(k, "dew_point", TEMPERATURE, DEW_POINT, .at = 0x26, SIXTEENTHS), \
	      MEASURED(k, "heat_index", TEMPERATURE, FELT(DEGREES_C), .at = 0x2a, SIXTEENTHS), \
	      MEASURED(k, "humidex", FLOAT, FELT(""), .at = 0x28, SIXTEENTHS), \
	      MEASURED(k, "humidity", FLOAT, MEASURES(-10, 110, 4, "%"), .at = 0x24, SIXTEENTHS)) \
	air(MEASURED(k, "inHg", FLOAT, MEASURES(0.3, 38.4, 3, "inHg"), .at = 0x2f, FINE)) \
	light(MEASURED(k, "light", UNSIGNED, MEASURES(0, 0xffffff, 0, "lx"), .at = 0x32, .bytes = 3)) \
	air(MEASURED(k, "pressure", PRESSURE, MEASURES(10, 1300, 3, "mbar"), .at = 0x2c, FINE)) \
	RELAY(k, MEMORY, 0x5e), DIRECTORY_OF(k, "set_alarm"), \
	HIDDEN(k, "set_alarm/alarm_function", BOTH, MEMORY, 2, .at = 0x40), \
	water(ENABLES(k, "dew_point", 2, 4), ENABLES(k, "heat_index", 2, 8), \
	      ENABLES(k, "humidex", 2, 6), ENABLES(k, "humidity", 2, 2)) \
	air(ENABLES(k, "inHg", 2, 12)) light(ENABLES(k, "light", 2, 14)) \
	air(ENABLES(k, "pressure", 2, 10)) ENABLES(k, "temp", 2, 0), \
	MEASURED(k, "temperature", TEMPERATURE, CELSIUS, .at = 0x22, SIXTEENTHS), \
	DIRECTORY_OF(k, "threshold"), \
	water(BYTES(k, "dew_point", TEMPERATURE, DEGREES_C, 0x46), \
	      BYTES(k, "heat_index", TEMPERATURE, DEGREES_C, 0x4a), \
	      BYTES(k, "humidex", FLOAT, "", 0x48), BYTES(k, "humidity", FLOAT, "%", 0x44)) \
	air(FINES(k, "inHg", FLOAT, "inHg", 0x52)) \
	light(LIMIT(k, "light_hi", UNSIGNED, "lx", .at = 0x58, .bytes = 3), \
	      LIMIT(k, "light_low", UNSIGNED, "lx", .at = 0x5b, .bytes = 3)) \
	air(FINES(k, "pressure", PRESSURE, "mbar", 0x4c)) BYTES(k, "temp", TEMPERATURE, DEGREES_C, 0x42)

/* EDS0071 and EDS0072 differ in what their limits of the resistance are called. */
#define RTD(k, upper, lower) \
	HEAD(k, MEMORY, 0x5e), upper(FLAGS(k, "RTD", 0x36, 1, 2)) CLEAR(k), \
	lower(FLAGS(k, "resistance", 0x36, 1, 2)) \
	STATE(k, 1, 0x36), \
	FLAGS(k, "temp", 0x36, 1, 0), DIRECTORY_OF(k, "calibration"), \
	OF(k, "calibration/constant", UNSIGNED, STABLE, READ, \
	   FIELD(MEMORY, .at = 0x30, .bytes = 4)), \
	OF(k, "calibration/key", UNSIGNED, STABLE, BOTH, FIELD(MEMORY, .at = 0x5c)), \
	DIRECTORY_OF(k, "counter"), \
	OF(k, "counter/samples", UNSIGNED, SECOND, READ, COUNTS_TO(UINT32_MAX), \
	   FIELD(MEMORY, .at = 0x38, .bytes = 4)), \
	SECONDS(k, 0x3c), SETTING(k, "delay", UNSIGNED, .at = 0x5d), \
	HIDDEN(k, "raw", READ, MEMORY, 3, .at = 0x28), RELAY(k, MEMORY, 0x5e), \
	MEASURED(k, "resistance", FLOAT, MEASURES(0, 4096, 3, OHM), .at = 0x25, FINE), \
	DIRECTORY_OF(k, "set_alarm"), \
	upper(ENABLES(k, "RTD", 1, 2)) \
	HIDDEN(k, "set_alarm/alarm_function", BOTH, MEMORY, 1, .at = 0x40), \
	lower(ENABLES(k, "resistance", 1, 2)) ENABLES(k, "temp", 1, 0), \
	MEASURED(k, "temperature", TEMPERATURE, MEASURES(-210, 860, 3, DEGREES_C), \
		 .at = 0x22, FINE), \
	DIRECTORY_OF(k, "threshold"), \
	FINES(k, "resistance", FLOAT, OHM, 0x48), FINES(k, "temp", TEMPERATURE, DEGREES_C, 0x42), \
	SETTING(k, "user_byte", UNSIGNED, .at = 0x41)

/* EDS0080 to EDS0085: currents (in A) or voltages, whose names sort differently. */
#define CHANNELS(k, name, life, access, n, step, unit_, where, ...) \
	OF(k, name, FLOAT, life, access, ELEMENTS(n, NUMBERS), __VA_ARGS__, \
	   FIELD(MEMORY, .at = (where), .bytes = 2, .stride = (step), .unit = (unit_)))
#define ANALOG(k, what, n, unit_, symbol, currents, voltages, ...) \
	HEAD(k, MEMORY, 0x9e), CLEAR(k), \
	currents(PAIRS(k, "alarm/" what "_hi", READ, n, MEMORY, .at = 0x2a), \
		 PAIRS(k, "alarm/" what "_low", READ, n, MEMORY, .at = 0x2a, .shift = 1)) \
	STATE(k, 2, 0x2a), \
	voltages(PAIRS(k, "alarm/" what "_hi", READ, n, MEMORY, .at = 0x2a), \
		 PAIRS(k, "alarm/" what "_low", READ, n, MEMORY, .at = 0x2a, .shift = 1)) \
	DIRECTORY_OF(k, "counter"), SECONDS(k, 0x2c), \
	currents(CHANNELS(k, what, VOLATILE, READ, n, 2, unit_, 0x30, __VA_ARGS__)) \
	CHANNELS(k, "max_" what, VOLATILE, READ, n, 2, unit_, 0x50, __VA_ARGS__), \
	OF(k, "memory", BINARY, VOLATILE, BOTH, .size = 160, FIELD(MEMORY), .how = WAY_MEMORY), \
	CHANNELS(k, "min_" what, VOLATILE, READ, n, 2, unit_, 0x40, __VA_ARGS__), DIRECTORY_OF(k, "pages"), \
	OF(k, "pages/page", BINARY, VOLATILE, BOTH, ELEMENTS(5, NUMBERS), .size = 32, \
	   FIELD(MEMORY), .how = WAY_MEMORY), \
	RELAY(k, MEMORY, 0x9e), DIRECTORY_OF(k, "set_alarm"), \
	HIDDEN(k, "set_alarm/alarm_function", BOTH, MEMORY, 2, .at = 0x9a), \
	PAIRS(k, "set_alarm/" what "_hi", BOTH, n, MEMORY, .at = 0x9a), \
	PAIRS(k, "set_alarm/" what "_low", BOTH, n, MEMORY, .at = 0x9a, .shift = 1), \
	DIRECTORY_OF(k, "threshold"), \
	CHANNELS(k, "threshold/" what "_hi", STABLE, BOTH, n, 4, unit_, 0x70, \
		 IN_UNIT(symbol)), \
	CHANNELS(k, "threshold/" what "_low", STABLE, BOTH, n, 4, unit_, 0x72, \
		 IN_UNIT(symbol))
/* What the words hold. */
#define AMPERES MEASURES(0, .032, 7, "A")
#define VOLTS MEASURES(0, 32, 4, "V")
#define CURRENT(k, n) ANALOG(k, "current", n, 1 / 2048000.0, "A", HAS, NOT, AMPERES)
#define VOLTAGE(k, n) \
	ANALOG(k, "volts", n, 1 / 2048.0, "V", NOT, HAS, VOLTS), \
	CHANNELS(k, "volts", VOLATILE, READ, n, 2, 1 / 2048.0, 0x30, VOLTS)

/* EDS0090 */
#define PINS(name, alarm_, life, access, ...) \
	OF(90, name, BITS, life, access, AGGREGATE(8, NUMBERS), FIELD(__VA_ARGS__), \
	   .alarm = (alarm_))
#define RESET(name, where, alarm_) \
	OF(90, name, BITS, VOLATILE, BOTH, AGGREGATE(8, NUMBERS), \
	   FIELD(SWITCHES, .at = (where) - EDS_SWITCHES_AT), .alarm = (alarm_), \
	   .how = WAY_RESET)

static const struct property properties[] = {
	ENVIRONMENT(64, NOT, NOT, NOT),
	ENVIRONMENT(65, HAS, NOT, NOT),
	ENVIRONMENT(66, NOT, HAS, NOT),
	ENVIRONMENT(67, NOT, NOT, HAS),
	ENVIRONMENT(68, HAS, HAS, HAS),

	HEAD(70, MEMORY, 0x5e),
	CLEAR(70),
	STATE(70, 1, 0x36),
	FLAGS(70, "vib", 0x36, 1, 2),
	DIRECTORY_OF(70, "counter"),
	SECONDS(70, 0x3c),
	RELAY(70, MEMORY, 0x5e),
	DIRECTORY_OF(70, "set_alarm"),
	HIDDEN(70, "set_alarm/alarm_function", BOTH, MEMORY, 1, .at = 0x40),
	ENABLES(70, "vib", 1, 2),
	DIRECTORY_OF(70, "threshold"),
	LIMIT(70, "vib_hi", TEMPERATURE, "", .at = 0x44, .bytes = 2),
	LIMIT(70, "vib_low", TEMPERATURE, "", .at = 0x46, .bytes = 2),
	MEASURED(70, "vib_level", UNSIGNED, WORD, .at = 0x24, .bytes = 2),
	MEASURED(70, "vib_max", UNSIGNED, WORD, .at = 0x28, .bytes = 2),
	MEASURED(70, "vib_min", UNSIGNED, WORD, .at = 0x30, .bytes = 2),
	MEASURED(70, "vib_peak", UNSIGNED, WORD, .at = 0x26, .bytes = 2),

	RTD(71, NOT, HAS),
	RTD(72, HAS, NOT),
	CURRENT(80, 8),
	VOLTAGE(82, 8),
	CURRENT(83, 4),
	VOLTAGE(85, 4),

	HEAD(90, SWITCHES, 14),
	CLEAR(90),
	PAIRS(90, "alarm/hi", READ, 8, MEMORY, .at = 0x2a),
	PAIRS(90, "alarm/low", READ, 8, MEMORY, .at = 0x2a, .shift = 1),
	STATE(90, 2, 0x2a),
	DIRECTORY_OF(90, "counter"),
	OF(90, "counter/pulses", UNSIGNED, VOLATILE, READ, ELEMENTS(8, NUMBERS),
	   FIELD(MEMORY, .at = 0x30, .bytes = 4, .stride = 4), COUNTS_TO(UINT32_MAX)),
	RESET("counter/reset", 0x54, 0),
	SECONDS(90, 0x2c),
	PINS("input", 0, STABLE, READ, MEMORY, .at = 0x22),
	DIRECTORY_OF(90, "latch"),
	RESET("latch/reset", 0x55, ALARM_CLEARS),
	PINS("latch/state", ALARM_LATCH | ALARM_STAYS, VOLATILE, READ, MEMORY, .at = 0x23),
	DIRECTORY_OF(90, "output"),
	PINS("output/off", 0, VOLATILE, READ, SWITCHES, .at = 12),
	RESET("output/reset", 0x55, 0),
	PINS("output/set", 0, VOLATILE, BOTH, SWITCHES, .at = 12),
	RELAY(90, SWITCHES, 14),
	DIRECTORY_OF(90, "set_alarm"),
	HIDDEN(90, "set_alarm/alarm_function", BOTH, SWITCHES, 2, .at = 0),
	PAIRS(90, "set_alarm/hi", BOTH, 8, SWITCHES, .at = 0),
	PAIRS(90, "set_alarm/low", BOTH, 8, SWITCHES, .at = 0, .shift = 1),

	PROPERTY("device_id", UNSIGNED, STABLE, READ, FIELD(MEMORY, .at = 0x1e, .bytes = 2)),
	PROPERTY("device_type", ASCII, VOLATILE, READ, .size = 7, .how = WAY_TYPE),
	PROPERTY("memory", BINARY, VOLATILE, BOTH, .size = 96, FIELD(MEMORY), .how = WAY_MEMORY),
	PROPERTY_DIR("pages"),
	PROPERTY("pages/page", BINARY, VOLATILE, BOTH, ELEMENTS(3, NUMBERS), .size = 32,
		 FIELD(MEMORY), .how = WAY_MEMORY),
	PROPERTY("tag", ASCII, STABLE, READ, .size = 30, .how = WAY_TAG),
};
#define S(k, name) {"EDS00" #k "/" name, name}
/* clang-format on */

CHIP_FAMILY(7e, "EDS", CHECKSUM, .alarms = true, .latches = true,
            .flags = FLAG_ALARM | FLAG_TEMPERATURE, .several = true, .identify = eds_identify,
            .model = "device_type",
            SCAN(S(64, "temperature"), S(65, "temperature"), S(65, "humidity"), S(65, "dew_point"),
                 S(65, "heat_index"), S(65, "humidex"), S(66, "temperature"), S(66, "pressure"),
                 S(66, "inHg"), S(67, "temperature"), S(67, "light"), S(68, "temperature"),
                 S(68, "humidity"), S(68, "dew_point"), S(68, "heat_index"), S(68, "humidex"),
                 S(68, "pressure"), S(68, "inHg"), S(68, "light"), S(70, "vib_level"),
                 S(70, "vib_peak"), S(70, "vib_min"), S(70, "vib_max"), S(71, "temperature"),
                 S(71, "resistance"), S(72, "temperature"), S(72, "resistance"), S(80, "current"),
                 S(83, "current"), {"EDS0082/volts", "volt"}, {"EDS0085/volts", "volt"},
                 {"EDS0090/input.BYTE", "inputs"}, {"EDS0090/output/set.BYTE", "outputs"},
                 {"EDS0090/counter/pulses", "count"}),
            AREAS(areas), HOW(how), PROPERTIES(properties));
