/* SPDX-License-Identifier: MIT */
/*
 * The battery gauges, each a table over the areas of gauge.c, by their data sheets:
 * - DS2720: "Efficient, Addressable Single-Cell Rechargeable Lithium Protection IC"
 * - DS2740: "High-Precision Coulomb Counter"
 * - DS2751: "Multichemistry Battery Fuel Gauge"
 * - DS2755: none could be had: registers as in the DS2756 ("High-Accuracy Battery Fuel Gauge");
 *   alarm_set and the bits of the status as OWFS has them
 * - DS2760: "High-Precision Li+ Battery Monitor"
 * - DS2770: "Battery Monitor and Charge Controller"
 * - DS2780: "Standalone Fuel Gauge IC"
 * - DS2781: "1-Cell or 2-Cell Stand-Alone Fuel Gauge"
 */
#include "hal/chips/batteries/gauge.h"
#include "hal/chips/batteries/ws603.h"
#include "hal/chips/thermometers/thermocouple.h"

/* clang-format off */
#define GAUGE_LOCK(n, register_) \
	PROPERTY("lock", YESNO, STABLE, BOTH, ELEMENTS(n, NUMBERS), .arg = (register_), \
	         .how = WAY_LOCK)
#define GAUGE_WORD(text, where, unit_, ...) \
	PROPERTY(text, FLOAT, VOLATILE, READ, \
	         FIELD(WORDS, .at = (where), .bytes = 2, .big_endian = true, .is_signed = true, \
	               .unit = (unit_)), __VA_ARGS__)
/* What the register of the voltage across the resistor holds, in V and, inside, in A. */
#define GAUGE_VIS_COARSE MEASURES(-0.064, 0.064, 6, "V")
#define GAUGE_VIS_FINE MEASURES(-0.0512, 0.0512, 7, "V")
#define GAUGE_CURRENT_COARSE MEASURES(-2.56, 2.56, 6, "A")
#define GAUGE_CURRENT_FINE MEASURES(-2.048, 2.048, 7, "A")
/* 10 bits and sign; the chip measures from 0 on, within 5 mV of one cell. */
#define GAUGE_VOLT(unit_) \
	PROPERTY("volt", FLOAT, VOLATILE, READ, \
	         FIELD(WORDS, .at = 0x0c, .bytes = 2, .big_endian = true, .is_signed = true, \
	               .shift = 5, .unit = (unit_)), \
	         MEASURES(-0.02, (unit_) * 1023.5, 3, "V"))
/* Registers hold -128 to 127.875; no such chip lives below -55 or above 125, within 3. */
#define GAUGE_CELSIUS MEASURES(-58, 127.875, 3, DEGREES_C)
#define GAUGE_TEMPERATURE(where) \
	PROPERTY("temperature", TEMPERATURE, VOLATILE, READ, \
	         FIELD(WORDS, .at = (where), .bytes = 2, .big_endian = true, .is_signed = true, \
	               .shift = 5, .unit = .125), GAUGE_CELSIUS)
/* The accumulated current: 6.25 uVh, 15 bits and sign. */
#define GAUGE_CHARGE(text, resistor, unit_) \
	PROPERTY(text, FLOAT, VOLATILE, BOTH, \
	         FIELD(CHARGE, .bytes = 2, .big_endian = true, .is_signed = true, \
	               .unit = 6.25e-6 / (resistor)), \
	         MEASURES(-.2048 / (resistor), .2048 / (resistor), 6, unit_))
#define GAUGE_AMPHOURS GAUGE_CHARGE("amphours", GAUGE_RESISTOR, "Ah")
#define GAUGE_VOLTHOURS GAUGE_CHARGE("volthours", 1, "Vh")
#define GAUGE_BIT(text, life_, access_, area_, where, bit) \
	PROPERTY(text, YESNO, life_, access_, \
	         FIELD(area_, .at = (where), .shift = (bit), .bits = 1))
/* To write a bit beside that of PIO is to switch the output to what the pin shows. */
#define GAUGE_BESIDE_PIO(text, life_, area_, bit) \
	PROPERTY(text, YESNO, life_, BOTH, FIELD(area_, .shift = (bit), .bits = 1), \
	         .how = WAY_REFUSED)
/* Each type ends inside the range of all of them; range_low and range_high have its own. */
#define GAUGE_COUPLE(text, type_, where, fine) \
	PROPERTY_DIR(text), \
	PROPERTY(text "/range_high", TEMPERATURE, STATIC, READ, .offline = true, \
	         .arg = (type_), .how = WAY_COUPLE_HIGH), \
	PROPERTY(text "/range_low", TEMPERATURE, STATIC, READ, .offline = true, \
	         .arg = (type_), .how = WAY_COUPLE_LOW), \
	PROPERTY(text "/temperature", TEMPERATURE, VOLATILE, READ, \
	         .arg = (type_) | (where) << 8 | (fine) << 16, \
	         MEASURES(-270, 1820, 3, DEGREES_C), .how = WAY_COUPLE)
#define GAUGE_COUPLES(where, fine) \
	GAUGE_COUPLE("typeB", TYPE_B, where, fine), GAUGE_COUPLE("typeE", TYPE_E, where, fine), \
	GAUGE_COUPLE("typeJ", TYPE_J, where, fine), GAUGE_COUPLE("typeK", TYPE_K, where, fine), \
	GAUGE_COUPLE("typeN", TYPE_N, where, fine), GAUGE_COUPLE("typeR", TYPE_R, where, fine), \
	GAUGE_COUPLE("typeS", TYPE_S, where, fine), GAUGE_COUPLE("typeT", TYPE_T, where, fine)
#define GAUGE_PIO(access_, area_, bit) \
	PROPERTY("PIO", YESNO, VOLATILE, access_, \
	         FIELD(area_, .shift = (bit), .bits = 1, .inverted = true))
#define GAUGE_OFFSET(text, life_, symbol, ...) \
	PROPERTY(text, FLOAT, life_, BOTH, FIELD(__VA_ARGS__), IN_UNIT(symbol))
/* Pages of the EEPROM that can be locked. */
#define GAUGE_PAGES(n, bytes_, ...) \
	PROPERTY_DIR("pages"), \
	PROPERTY("pages/page", BINARY, VOLATILE, BOTH, ELEMENTS(n, NUMBERS), .size = (bytes_), \
	         FIELD(__VA_ARGS__))

#define WS603_BYTE(text, access_, arg_) \
	PROPERTY(text, UNSIGNED, VOLATILE, access_, .hidden = true, .arg = (arg_), \
	         .how = WAY_WS603_BYTE)
#define WS603_BYTES(text, life_, arg_) \
	PROPERTY(text, BINARY, life_, READ, .size = 5, .hidden = true, .arg = (arg_), \
	         .how = WAY_WS603_BYTES)

/* WS603: a weather station with a DS2760 (ws603.h). */
#define WS603_PROPERTIES \
	PROPERTY_DIR("WS603"), \
	PROPERTY_DIR("WS603/LED"), \
	PROPERTY("WS603/LED/control", UNSIGNED, STABLE, WRITE, AGGREGATE(4, NUMBERS), \
	         .how = WAY_WS603_LIGHTS), \
	WS603_BYTE("WS603/LED/model", READ, WS603_PARAMETERS), \
	WS603_BYTE("WS603/LED/status", READ, WS603_DATA | 2 << 8), \
	PROPERTY_DIR("WS603/calibration"), \
	WS603_BYTE("WS603/calibration/direction", BOTH, WS603_PARAMETERS | 2 << 8), \
	WS603_BYTE("WS603/calibration/wind_speed", BOTH, WS603_PARAMETERS | 1 << 8), \
	WS603_BYTES("WS603/data_string", VOLATILE, WS603_DATA), \
	WS603_BYTE("WS603/direction", READ, WS603_DATA | 1 << 8), \
	PROPERTY_DIR("WS603/light"), \
	WS603_BYTE("WS603/light/intensity", READ, WS603_DATA | 3 << 8), \
	WS603_BYTE("WS603/light/threshold", READ, WS603_PARAMETERS | 3 << 8), \
	WS603_BYTES("WS603/param_string", STABLE, WS603_PARAMETERS), \
	PROPERTY("WS603/temperature", TEMPERATURE, VOLATILE, READ, \
	         FIELD(WORDS, .at = 0x18, .bytes = 2, .big_endian = true, .is_signed = true, \
	               .shift = 5, .unit = .125), GAUGE_CELSIUS), \
	WS603_BYTE("WS603/volt", READ, WS603_DATA | 4 << 8), \
	PROPERTY("WS603/wind_speed", FLOAT, VOLATILE, READ, .hidden = true, \
	         MEASURES(0, HUGE_VAL, 2, "m/s"), .how = WAY_WS603_WIND)

#define FLAG(text, area_, bit) GAUGE_BIT(text, VOLATILE, BOTH, area_, 0, bit)
/* What stands in the status register of some, from their EEPROM. */
#define READ_ONLY(text, where, bit) GAUGE_BIT(text, STABLE, READ, BYTES, where, bit)
#define SENSED(where, bit) GAUGE_BIT("sensed", VOLATILE, READ, BYTES, where, bit)
#define VIS_COARSE GAUGE_WORD("vis", 0x0e, GAUGE_COARSE, GAUGE_VIS_COARSE)
#define VIS_FINE GAUGE_WORD("vis", 0x0e, GAUGE_FINE, GAUGE_VIS_FINE)
#define LISTS(table) AREAS(gauge_areas), HOW(gauge_how), PROPERTIES(table)
#define SCAN_CURRENT \
	{"temperature", "temperature"}, {"volt", "volt"}, {"current", "current"}, \
	{"amphours", "amphours"}
#define SCAN_VIS \
	{"temperature", "temperature"}, {"volt", "volt"}, {"vis", "vis"}, \
	{"volthours", "volthours"}, {"sensed", "input"}

static const struct property ds2720[] = {
	FLAG("cc", PINS_OF, 3),
	FLAG("ce", PROTECTION, 1),
	FLAG("dc", PINS_OF, 2),
	FLAG("de", PROTECTION, 0),
	FLAG("doc", PROTECTION, 4),
	GAUGE_LOCK(2, 0x07),
	AREA_MEMORY(MEMORY, 256),
	FLAG("ot", SPECIAL_08, 0),
	FLAG("ov", PROTECTION, 7),
	GAUGE_PAGES(2, 4, EEPROM4, .at = 0x20, .stride = 0x10),
	FLAG("psf", SPECIAL_08, 7),
	FLAG("uv", PROTECTION, 6),
};
CHIP_FAMILY(31, "DS2720", PRESENCE, SCAN({"present", "present"}), LISTS(ds2720));

/* Steps of 1.5625 uV; "vis_B" is of a DS2740B, whose 13 bits stand at the top of the 16. */
static const struct property ds2740[] = {
	GAUGE_PIO(BOTH, SPECIAL_08, 6),
	AREA_MEMORY(MEMORY, 256),
	FLAG("smod", STATUS, 6),
	VIS_FINE,
	GAUGE_WORD("vis_B", 0x0e, GAUGE_FINE, GAUGE_VIS_FINE),
	GAUGE_VOLTHOURS,
};
CHIP_FAMILY(36, "DS2740", PRESENCE,
            SCAN({"vis", "vis"}, {"volthours", "volthours"}, {"PIO", "switch"}), LISTS(ds2740));

/* It has a resistor inside. */
static const struct property ds2751[] = {
	GAUGE_PIO(WRITE, SPECIAL_08, 6),
	GAUGE_AMPHOURS,
	GAUGE_WORD("current", 0x0e, GAUGE_COARSE / GAUGE_RESISTOR, GAUGE_CURRENT_COARSE),
	GAUGE_OFFSET("currentbias", VOLATILE, "A", EEPROM, GAUGE_BIAS(GAUGE_RESISTOR)),
	GAUGE_BIT("defaultpmod", STABLE, BOTH, EEPROM, 0x31, 5),
	GAUGE_LOCK(2, 0x07),
	AREA_MEMORY(MEMORY, 256),
	GAUGE_PAGES(2, 16, EEPROM, .at = 0x20),
	READ_ONLY("pmod", 0x01, 5),
	GAUGE_BESIDE_PIO("por", STABLE, SPECIAL_08, 0),
	SENSED(0x08, 6),
	GAUGE_TEMPERATURE(0x18),
	GAUGE_COUPLES(0x18, 0),
	/* the status register has it from the EEPROM */
	GAUGE_BIT("uven", STABLE, BOTH, EEPROM, 0x31, 3),
	GAUGE_OFFSET("vbias", STABLE, "V", EEPROM, GAUGE_BIAS(1)),
	VIS_COARSE,
	GAUGE_VOLT(.00488),
	GAUGE_VOLTHOURS,
};
CHIP_FAMILY(51, "DS2751", PRESENCE, SCAN(SCAN_CURRENT, {"sensed", "input"}), LISTS(ds2751));

/* The status register has them from the EEPROM. */
#define SETTING(text, bit) GAUGE_BIT(text, STABLE, BOTH, EEPROM32, 0x31, bit)
static const struct property ds2755[] = {
	GAUGE_PIO(WRITE, SPECIAL_08, 6),
	PROPERTY("alarm_set", FLOAT, VOLATILE, BOTH, FIELD(ALARM, .is_signed = true)),
	SETTING("defaultpmod", 5),
	SETTING("ios", 2),
	GAUGE_LOCK(3, 0x07),
	AREA_MEMORY(MEMORY, 256),
	SETTING("ovd", 0),
	GAUGE_PAGES(3, 32, EEPROM32, .at = 0x20),
	READ_ONLY("pie0", 0x01, 6),
	READ_ONLY("pie1", 0x01, 7),
	READ_ONLY("pmod", 0x01, 5),
	GAUGE_BESIDE_PIO("por", STABLE, SPECIAL_08, 7),
	READ_ONLY("rnaop", 0x01, 4),
	SENSED(0x08, 6),
	GAUGE_TEMPERATURE(0x18),
	GAUGE_COUPLES(0x18, 0),
	SETTING("uben", 1),
	SETTING("uven", 3),
	GAUGE_OFFSET("vbias", STABLE, "V", EEPROM32, .at = 0x33, .is_signed = true,
	             .unit = 1.95e-6),
	VIS_COARSE,
	GAUGE_WORD("vis_avg", 0x1a, 1.953e-6, GAUGE_VIS_COARSE),
	GAUGE_VOLT(.00488),
	GAUGE_VOLTHOURS,
};
CHIP_FAMILY(35, "DS2755", PRESENCE, .flags = FLAG_ALARM, SCAN(SCAN_VIS), LISTS(ds2755));

/*
 * It has protection. Recall Data sets CE and DE to their defaults: so only what is written goes by
 * way of the EEPROM, and what is read is its shadow.
 */
#define SHADOW(text, bit, way) \
	PROPERTY(text, YESNO, STABLE, BOTH, FIELD(BYTES, .at = 0x31, .shift = (bit), .bits = 1), \
	         .how = (way))
static const struct property ds2760[] = {
	GAUGE_PIO(WRITE, SPECIAL_08, 6),
	WS603_PROPERTIES,
	GAUGE_AMPHOURS,
	FLAG("cc", PINS_OF, 3),
	FLAG("ce", PROTECTION, 1),
	FLAG("coc", PROTECTION, 5),
	GAUGE_WORD("current", 0x0e, GAUGE_COARSE / GAUGE_RESISTOR, GAUGE_CURRENT_COARSE),
	PROPERTY("currentbias", FLOAT, VOLATILE, BOTH, FIELD(BYTES, GAUGE_BIAS(GAUGE_RESISTOR)),
	         IN_UNIT("A"), .how = WAY_CURRENTBIAS),
	FLAG("dc", PINS_OF, 2),
	FLAG("de", PROTECTION, 0),
	SHADOW("defaultpmod", 5, WAY_PMOD),
	SHADOW("defaultswen", 3, WAY_SWEN),
	FLAG("doc", PROTECTION, 4),
	GAUGE_LOCK(2, 0x07),
	AREA_MEMORY(MEMORY, 256),
	GAUGE_BIT("mstr", VOLATILE, READ, BYTES, 0x08, 5),
	FLAG("ov", PROTECTION, 7),
	PROPERTY_DIR("pages"),
	PROPERTY("pages/page", BINARY, VOLATILE, BOTH, ELEMENTS(2, NUMBERS), .size = 16,
	         FIELD(MEMORY, .at = 0x20), .how = WAY_PAGE),
	READ_ONLY("pmod", 0x01, 5),
	GAUGE_BESIDE_PIO("ps", VOLATILE, SPECIAL_08, 7),
	SENSED(0x08, 6),
	READ_ONLY("swen", 0x01, 3),
	GAUGE_TEMPERATURE(0x18),
	GAUGE_COUPLES(0x18, 0),
	FLAG("uv", PROTECTION, 6),
	PROPERTY("vbias", FLOAT, STABLE, BOTH, FIELD(BYTES, GAUGE_BIAS(1)), IN_UNIT("V"),
	         .how = WAY_VBIAS),
	VIS_COARSE,
	GAUGE_VOLT(.00488),
	GAUGE_VOLTHOURS,
};
CHIP_FAMILY(30, "DS2760", PRESENCE, SCAN(SCAN_CURRENT, {"sensed", "input"}), LISTS(ds2760));

/* In the status, which takes it from the EEPROM: pages/page.1 is written. */
#define REFRESHED(text, bit) \
	PROPERTY(text, YESNO, STABLE, BOTH, FIELD(BYTES, .at = 0x01, .shift = (bit), .bits = 1), \
	         .how = WAY_REFUSED)
#define BIAS_FINE(resistor) \
	.at = 0x32, .bytes = 2, .big_endian = true, .is_signed = true, \
	.unit = GAUGE_FINE / (resistor)
static const struct property ds2770[] = {
	GAUGE_AMPHOURS,
	PROPERTY("charge", YESNO, STABLE, WRITE, .how = WAY_CHARGE),
	REFRESHED("cini", 1),
	GAUGE_BIT("cstat0", STABLE, BOTH, STATUS, 0, 6),
	GAUGE_BIT("cstat1", STABLE, BOTH, STATUS, 0, 7),
	REFRESHED("ctype", 0),
	GAUGE_WORD("current", 0x0e, GAUGE_FINE / GAUGE_RESISTOR, GAUGE_CURRENT_FINE),
	GAUGE_OFFSET("currentbias", VOLATILE, "A", EEPROM, BIAS_FINE(GAUGE_RESISTOR)),
	GAUGE_BIT("defaultpmod", STABLE, BOTH, EEPROM, 0x31, 5),
	GAUGE_LOCK(3, 0x07),
	AREA_MEMORY(MEMORY, 256),
	GAUGE_PAGES(3, 16, EEPROM, .at = 0x20),
	REFRESHED("pmod", 5),
	PROPERTY("refresh", YESNO, STABLE, WRITE, .how = WAY_REFUSED),
	GAUGE_TEMPERATURE(0x18),
	PROPERTY("timer", FLOAT, VOLATILE, BOTH,
	         FIELD(TIMER, .bytes = 2, .big_endian = true, .unit = .015625),
	         MEASURES(0, 1024, 6, "h")),
	GAUGE_COUPLES(0x18, 1),
	GAUGE_OFFSET("vbias", STABLE, "V", EEPROM, BIAS_FINE(1)),
	VIS_FINE,
	GAUGE_VOLT(.00488),
	GAUGE_VOLTHOURS,
};
CHIP_FAMILY(2e, "DS2770", PRESENCE, SCAN(SCAN_CURRENT), LISTS(ds2770));

/*
 * DS2780 and DS2781 compute capacities. The control register is the first byte of the parameters in
 * the EEPROM.
 */
#define CONTROL(text, bit) FLAG(text, PARAMETERS, bit)
#define PARAMETER(text, life_, where, unit_) \
	GAUGE_OFFSET(text, life_, "V", PARAMETERS, .at = (where), .is_signed = true, \
	             .unit = (unit_))
#define FUEL_PAGES GAUGE_PAGES(2, 16, EEPROM, .at = 0x20, .stride = 0x40)
#define VIS_AVERAGE GAUGE_WORD("vis_avg", 0x08, GAUGE_FINE, GAUGE_VIS_FINE)
static const struct property ds2780[] = {
	GAUGE_PIO(WRITE, SPECIAL_15, 0),
	FLAG("aef", STATUS, 6),
	FLAG("chgtf", STATUS, 7),
	CONTROL("dc", 3),
	FLAG("learnf", STATUS, 4),
	GAUGE_LOCK(2, 0x1f),
	AREA_MEMORY(MEMORY, 256),
	CONTROL("nben", 7),
	FUEL_PAGES,
	CONTROL("pmod", 5),
	FLAG("porf", STATUS, 1),
	CONTROL("rnaop", 4),
	FLAG("sef", STATUS, 5),
	SENSED(0x15, 0),
	GAUGE_TEMPERATURE(0x0a),
	GAUGE_COUPLES(0x0a, 1),
	CONTROL("uven", 6),
	FLAG("uvf", STATUS, 2),
	PARAMETER("vbias", STABLE, 0x01, GAUGE_FINE),
	VIS_FINE,
	VIS_AVERAGE,
	GAUGE_VOLT(.00488),
	GAUGE_VOLTHOURS,
};
CHIP_FAMILY(32, "DS2780", PRESENCE, SCAN(SCAN_VIS), LISTS(ds2780));

static const struct property ds2781[] = {
	GAUGE_PIO(WRITE, SPECIAL_15, 0),
	FLAG("aef", STATUS, 6),
	GAUGE_LOCK(2, 0x1f),
	AREA_MEMORY(MEMORY, 256),
	FUEL_PAGES,
	CONTROL("pmod", 5),
	FLAG("porf", STATUS, 1),
	FLAG("sef", STATUS, 5),
	SENSED(0x15, 0),
	GAUGE_TEMPERATURE(0x0a),
	GAUGE_COUPLES(0x0a, 1),
	CONTROL("uven", 6),
	FLAG("uvf", STATUS, 2),
	PARAMETER("vbias", STABLE, 0x01, GAUGE_FINE),
	VIS_FINE,
	VIS_AVERAGE,
	PARAMETER("vis_offset", VOLATILE, 0x1b, 1.56e-6),
	GAUGE_VOLT(.00976),
	GAUGE_VOLTHOURS,
};
CHIP_FAMILY(3d, "DS2781", PRESENCE, SCAN(SCAN_VIS), LISTS(ds2781));
/* clang-format on */
