/* SPDX-License-Identifier: MIT */
/*
 * DS2438 (data sheet 19-5099): temperature, two voltages, a current, a clock. ds2438.c reads and
 * writes its memory, ds2438_measure.c measures; what stands on boards with this chip (humidity,
 * pressure, light) is computed here.
 * DS2437: its forerunner (data sheet, "Smart Battery Monitor"), with the same memory and commands.
 *
 * TMP1826 and TMP1827 answer with the same family code: tmp1826.c tells them apart before anything
 * else is asked of a chip, and reads them.
 */
#include <errno.h>
#include <math.h>
#include <string.h>

#include "hal/chips/batteries/ds2438_measure.h"
#include "hal/chips/family.h"
#include "hal/chips/thermometers/tmp1826.h"

#define OFFSET_AT 13 /* page 1, byte 5 */

/* In the upper 13 bits of two bytes. */
static int read_offset(struct txn *txn)
{
	uint8_t bytes[2];
	int err = area_read(txn, &ds2438_pages, OFFSET_AT, bytes, sizeof(bytes));

	if (!err)
		txn->number[0] = (double)(uint32_t)(ds2438_word(bytes) >> 3);
	return err;
}

/* The chip takes it only while it does not measure the current. */
static int write_offset(struct txn *txn)
{
	struct ds2438_visit *visit = ds2438_visit(txn);
	int value = (int32_t)(uint32_t)(int64_t)txn->number[0]; /* as it is read, or below zero */
	int err;

	if (value < -256 || value > 255)
		return -EINVAL;
	uint16_t stored = (uint16_t)(value * 8);
	uint8_t bytes[] = {(uint8_t)stored, (uint8_t)(stored >> 8)};
	switch (visit->stage) {
	case 0:
		err = ds2438_configure(txn, DS2438_IAD, 0, &visit->before);
		break;
	case 1:
		err = ds2438_patch(txn, OFFSET_AT / 8, OFFSET_AT % 8, bytes, sizeof(bytes));
		break;
	default:
		return visit->before & DS2438_IAD
		               ? ds2438_configure(txn, DS2438_IAD, DS2438_IAD, NULL)
		               : 0;
	}
	visit->stage += err == 0;
	return err < 0 ? err : TXN_MORE;
}

/* --- Sensors on boards with a DS2438, from the data sheets of the sensors --- */

enum sensor_humidity { HIH3600, HIH4000, HIH5030, HTM1735, DATANAB };
enum sensor_setting { B1_GAIN, B1_OFFSET, S3_GAIN };

/*
 * The Hobby Boards' settings stand in page 3, 16 bits each. 0 is not set: 46 mV/mbar and 904.7
 * mbar, and a SFH203P of 9.5 nA/lx.
 */
#define SETTING_PAGE 3
#define SHUNT_OHM 390.0

static const struct {
	uint8_t at;
	bool is_signed;
	double unit, standard;
} settings[] = {
	[S3_GAIN] = {2, false, 0.1, 1 / 0.0095},
	[B1_GAIN] = {4, false, 0.001, 1 / 0.046},
	[B1_OFFSET] = {6, true, 0.05, 904.7},
};

/* HIH3600 stands for the HIH-3610 with 0.8 V at 0 %RH whatever the supply; the others follow it. */
static double relative_humidity(int sensor, double celsius, double supply, double volt)
{
	double ratio = volt / supply, compensation = 1.0546 - 0.00216 * celsius;

	switch ((enum sensor_humidity)sensor) {
	case HIH3600:
		return (volt - 0.8) / supply / 0.0062 / compensation;
	case HIH4000:
	case DATANAB:
		return (ratio - 0.16) / 0.0062 / compensation;
	case HIH5030:
		return (ratio - 0.1515) / 0.00636 / compensation;
	case HTM1735:
		return 38.92 * volt - 41.98;
	}
	return 0;
}

static int sensor_read_humidity(struct txn *txn)
{
	const double *value = ds2438_visit(txn)->value;
	int sensor = txn->property->arg;
	unsigned what = 1 << DS2438_VAD;

	if (sensor != HTM1735)
		what |= 1 << DS2438_TEMPERATURE | 1 << DS2438_VDD;
	int err = ds2438_measure(txn, what);
	if (err)
		return err;
	if (sensor != HTM1735 && value[DS2438_VDD] <= 0)
		return -ENODATA;
	txn->number[0] = relative_humidity(sensor, value[DS2438_TEMPERATURE], value[DS2438_VDD],
	                                   value[DS2438_VAD]);
	return 0;
}

static double setting(const uint8_t page[8], int which)
{
	unsigned raw = page[settings[which].at] | (unsigned)page[settings[which].at + 1] << 8;

	if (raw == 0)
		return settings[which].standard;
	return (settings[which].is_signed ? (int16_t)raw : (int)raw) * settings[which].unit;
}

static int sensor_read_setting(struct txn *txn)
{
	uint8_t page[8];
	int err = area_read(txn, &ds2438_pages, 8 * SETTING_PAGE, page, 8);

	if (!err)
		txn->number[0] = setting(page, txn->property->arg);
	return err;
}

static int sensor_write_setting(struct txn *txn)
{
	int which = txn->property->arg;
	double scaled = txn->number[0] / settings[which].unit;

	if (!(scaled > (settings[which].is_signed ? -32768.5 : -0.5) && scaled < 32767.5))
		return -EINVAL;
	int16_t raw = (int16_t)(scaled < 0 ? scaled - 0.5 : scaled + 0.5);
	uint8_t bytes[] = {(uint8_t)raw, (uint8_t)((uint16_t)raw >> 8)};
	return ds2438_patch(txn, SETTING_PAGE, settings[which].at, bytes, sizeof(bytes));
}

/* The settings' page comes last. */
static int with_settings(struct txn *txn, enum ds2438_quantity what, uint8_t page[8])
{
	struct ds2438_visit *visit = ds2438_visit(txn);

	if (visit->stage <= DS2438_QUANTITIES) {
		int err = ds2438_measure(txn, 1u << what);

		if (!err)
			visit->stage = DS2438_QUANTITIES + 1;
		return err ? err : TXN_MORE;
	}
	return area_read(txn, &ds2438_pages, 8 * SETTING_PAGE, page, 8);
}

static int sensor_read_pressure(struct txn *txn)
{
	uint8_t page[8];
	int err = with_settings(txn, DS2438_VAD, page);

	if (!err)
		txn->number[0] = ds2438_visit(txn)->value[DS2438_VAD] * setting(page, B1_GAIN) +
		                 setting(page, B1_OFFSET);
	return err;
}

static int sensor_read_light(struct txn *txn)
{
	uint8_t page[8];
	int err = with_settings(txn, DS2438_VIS, page);

	if (err)
		return err;
	double microampere = ds2438_visit(txn)->value[DS2438_VIS] / SHUNT_OHM * 1e6;
	double lux = microampere * setting(page, S3_GAIN);
	txn->number[0] = txn->property->arg ? (lux < 1 ? 1 : lux) : microampere;
	return 0;
}

static int sensor_read_type(struct txn *txn)
{
	static const char *const types[] = {"MS-TH", "MS-TV", "MS-TL", "MS-TC", "MS-TW"};
	const char *type = "unknown";
	uint8_t page[8];
	int err = area_read(txn, &ds2438_pages, 8 * SETTING_PAGE, page, 8);

	if (err)
		return err;
	if (page[0] == 0)
		type = "MS-T";
	else if (page[0] >= 0x19 && page[0] < 0x19 + sizeof(types) / sizeof(types[0]))
		type = types[page[0] - 0x19];
	return property_text(txn, type);
}

/* --- The tables --- */

/* Sensors of 0 to 100 %RH within 5, and as much again for their ageing in wet air */
#define DS2438_HUMIDITY(text, which) \
	PROPERTY(text, FLOAT, VOLATILE, READ, .arg = (which), MEASURES(-10, 110, 2, "%"), \
	         .how = WAY_HUMIDITY)
#define DS2438_SETTING(text, kind, which, unit_) \
	PROPERTY(text, kind, STABLE, BOTH, .arg = (which), unit_, .how = WAY_SETTING)
#define DS2438_LIGHT(text, lux, ...) \
	PROPERTY(text, FLOAT, VOLATILE, READ, .arg = (lux), .how = WAY_LIGHT, __VA_ARGS__)

enum { PAGES = 1, MEMORY };
static const struct area *const areas[] = {[PAGES] = &ds2438_pages, [MEMORY] = &tmp1826_memory};

/* The same row serves both. */
static int read_temperature(struct txn *txn)
{
	return txn->device->kind == IS_TMP1826 ? tmp1826_read_temperature(txn)
	                                       : ds2438_read_measured(txn);
}

/* The chips are told apart before anything is asked of them. */
static int read_identity(struct txn *txn)
{
	return property_text(txn, family_type(txn->device));
}

#define WAYS(X) \
	X(HUMIDITY, .read = sensor_read_humidity) \
	X(PRESSURE, .read = sensor_read_pressure) \
	X(LIGHT, .read = sensor_read_light) \
	X(SETTING, .read = sensor_read_setting, .write = sensor_write_setting) \
	X(SENSOR_TYPE, .read = sensor_read_type) \
	X(RESET_DATANAB, .write = property_refuse) \
	X(MEASURED, .read = ds2438_read_measured) \
	X(FLAG, .write = ds2438_write_flag) \
	X(TIME, .write = ds2438_write_field) \
	X(PAGE, .write = ds2438_write_page) \
	X(OFFSET, .read = read_offset, .write = write_offset) \
	X(IDENTITY, .read = read_identity) \
	X(TEMPERATURE, .read = read_temperature) \
	X(LIMIT, .read = tmp1826_read_limit, .write = tmp1826_write_limit) \
	X(POWER, .read = tmp1826_read_power) \
	X(FORMAT, .read = tmp1826_read_format) \
	X(ALERT, .read = tmp1826_read_alert, .write = tmp1826_write_alert)
enum { WAY_NONE, WAYS(WAY_ENUM) };
static const struct property_how how[] = {WAYS(WAY_HOW)};

/* clang-format off */
#define MEASURED(text, kind, what, ...) \
	PROPERTY(text, kind, VOLATILE, READ, .arg = (what), .how = WAY_MEASURED, __VA_ARGS__)
/* -55 to +125 within 2, 0.03125; a TMP1826 up to 150 */
#define DS2438_CELSIUS(most) MEASURES(-58, most, 5, DEGREES_C)
/* 10 bits of 10 mV; on a VDD of 2.4 V at least the chip runs: a 0 is what a restart left */
#define DS2438_VAD_VOLTS MEASURES(0, 10.23, 2, "V")
#define DS2438_VDD_VOLTS MEASURES(2, 10.23, 2, "V")
/* 10 bits and sign of 0.2441 mV */
#define DS2438_VIS_VOLTS MEASURES(-0.25, 0.25, 5, "V")
/* A conversion takes 10 ms: what a restart may have left is not looked for. */
#define DS2438_LATEST(most) \
	MEASURED("latesttemp", TEMPERATURE, DS2438_TEMPERATURE, DS2438_CELSIUS(most))
#define FLAG(text, bit) \
	PROPERTY(text, YESNO, STABLE, BOTH, FIELD(PAGES, .shift = (bit), .bits = 1), \
	         .how = WAY_FLAG)
#define TIME(text, kind, life_, where) \
	PROPERTY(text, kind, life_, BOTH, FIELD(PAGES, .at = (where), .bytes = 4), \
	         .how = WAY_TIME)
#define DS2438_PAGES \
	PROPERTY("pages/page", BINARY, STABLE, BOTH, ELEMENTS(8, NUMBERS), .size = 8, \
	         FIELD(PAGES), .how = WAY_PAGE)
/* clang-format on */
#define TIMES \
	TIME("date", DATE, VOLATILE, 8), PROPERTY_DIR("disconnect"), \
		TIME("disconnect/date", DATE, VOLATILE, 16), \
		TIME("disconnect/udate", UNSIGNED, VOLATILE, 16), PROPERTY_DIR("endcharge"), \
		TIME("endcharge/date", DATE, VOLATILE, 20), \
		TIME("endcharge/udate", UNSIGNED, VOLATILE, 20)

/* How such a board marks itself is not documented. */
#define DATANAB_BOARD KIND(0)

#define OTHER(text, kind, life_, access_, ...) \
	PROPERTY(text, kind, life_, access_, .kinds = KIND(IS_TMP1826), __VA_ARGS__)

static const struct property properties[] = {
	PROPERTY_DIR("B1-R1-A"),
	DS2438_SETTING("B1-R1-A/gain", PRESSURE, B1_GAIN, IN_UNIT("")),
	DS2438_SETTING("B1-R1-A/offset", PRESSURE, B1_OFFSET, IN_UNIT("mbar")),
	/* absolute, of any sensor: gain and offset are settings */
	PROPERTY("B1-R1-A/pressure", PRESSURE, VOLATILE, READ, MEASURES(0, HUGE_VAL, 2, "mbar"),
                 .how = WAY_PRESSURE),
	FLAG("CA", 1),
	PROPERTY("DATANAB", DIRECTORY, STATIC, NONE, .kinds = DATANAB_BOARD),
	PROPERTY("DATANAB/humidity", FLOAT, VOLATILE, READ, .arg = DATANAB, .kinds = DATANAB_BOARD,
                 MEASURES(-10, 110, 2, "%"), .how = WAY_HUMIDITY),
	PROPERTY("DATANAB/reset", YESNO, STABLE, WRITE, .kinds = DATANAB_BOARD,
                 .how = WAY_RESET_DATANAB),
	FLAG("EE", 2),
	PROPERTY_DIR("HIH3600"),
	DS2438_HUMIDITY("HIH3600/humidity", HIH3600),
	PROPERTY_DIR("HIH4000"),
	DS2438_HUMIDITY("HIH4000/humidity", HIH4000),
	PROPERTY_DIR("HIH5030"),
	DS2438_HUMIDITY("HIH5030/humidity", HIH5030),
	PROPERTY_DIR("HTM1735"),
	DS2438_HUMIDITY("HTM1735/humidity", HTM1735),
	FLAG("IAD", 0),
	PROPERTY_DIR("MultiSensor"),
	PROPERTY("MultiSensor/type", ASCII, STABLE, READ, .size = 12, .how = WAY_SENSOR_TYPE),
	PROPERTY_DIR("S3-R1-A"),
	/* as the register of vis holds it, over 390 ohms: in the dark its offset may be below 0 */
	DS2438_LIGHT("S3-R1-A/current", 0, MEASURES(-642, 642, 3, "\u00b5A")),
	DS2438_SETTING("S3-R1-A/gain", FLOAT, S3_GAIN, IN_UNIT("")),
	DS2438_LIGHT("S3-R1-A/illuminance", 1, MEASURES(0, HUGE_VAL, 1, "lx")),
	MEASURED("VAD", FLOAT, DS2438_VAD, DS2438_VAD_VOLTS),
	MEASURED("VDD", FLOAT, DS2438_VDD, DS2438_VDD_VOLTS),
	OTHER("alert_high", YESNO, VOLATILE, BOTH, .arg = TMP1826_ALERT_HIGH, .how = WAY_ALERT),
	OTHER("alert_low", YESNO, VOLATILE, BOTH, .arg = TMP1826_ALERT_LOW, .how = WAY_ALERT),
	TIMES,
	DS2438_HUMIDITY("humidity", HIH3600),
	IDENTITY_ROW(WAY_IDENTITY, .kinds = KIND(IS_DS2438) | KIND(IS_TMP1826) | KIND(IS_NEITHER)),
	DS2438_LATEST(151),
	OTHER("memory", BINARY, VOLATILE, BOTH, .size = 256, FIELD(MEMORY)),
	PROPERTY("offset", UNSIGNED, STABLE, BOTH, .negative = true, .how = WAY_OFFSET),
	PROPERTY_DIR("pages"),
	DS2438_PAGES,
	OTHER("power", YESNO, VOLATILE, READ, .how = WAY_POWER),
	PROPERTY("temperature", TEMPERATURE, VOLATILE, READ, .arg = DS2438_TEMPERATURE,
                 DS2438_CELSIUS(151), .kinds = KIND(IS_DS2438) | KIND(IS_TMP1826),
                 .how = WAY_TEMPERATURE),
	OTHER("temphigh", TEMPERATURE, STABLE, BOTH, .arg = TMP1826_HIGH, .how = WAY_LIMIT),
	OTHER("templow", TEMPERATURE, STABLE, BOTH, .arg = TMP1826_LOW, .how = WAY_LIMIT),
	OTHER("tempoffset", TEMPGAP, STABLE, BOTH, .arg = TMP1826_OFFSET, .how = WAY_LIMIT),
	OTHER("tempres", UNSIGNED, STABLE, READ, .how = WAY_FORMAT),
	TIME("udate", UNSIGNED, SECOND, 8),
	MEASURED("vis", FLOAT, DS2438_VIS, DS2438_VIS_VOLTS),
};

/*
 * The alerts of a TMP1826 stay: reading cleared them in the chip, and no client has them yet. So
 * does what shows whether a DS2438 is a copy: one that has failed often has one try in a request,
 * and would never be known as a copy again.
 */
static void family_26_forget(struct device *device)
{
	struct tmp1826 *chip = device->own;
	uint8_t alerts = chip->alerts;
	bool genuine = chip->common.genuine;
	uint8_t kept = chip->common.kept;

	memset(chip, 0, sizeof(*chip));
	chip->alerts = alerts;
	chip->common.genuine = genuine;
	chip->common.kept = kept;
}

static const char *const types[] = {NULL, "DS2438", "TMP1826", "unknown"};

CHIP_FAMILY(26, "DS2438", PRESENCE, .flags = FLAG_VOLT | FLAG_TEMPERATURE,
            SCAN({"temperature", "temperature"}, {"humidity", "humidity"}, {"VDD", "vdd"},
                 {"VAD", "vad"}),
            .several = true, .types = types, .identify = tmp1826_identify,
            .forget = family_26_forget, .doubted = KIND(IS_NEITHER), .plain = KIND(IS_DS2438),
            AREAS(areas), HOW(how), PROPERTIES(properties));

/* The same chip with a family code that owserver knows besides. */
CHIP_FAMILY(a6, "DS2438", PRESENCE, .flags = FLAG_VOLT | FLAG_TEMPERATURE,
            SCAN({"temperature", "temperature"}, {"humidity", "humidity"}, {"VDD", "vdd"},
                 {"VAD", "vad"}),
            AREAS(areas), HOW(how), PROPERTIES(properties));

static const struct property ds2437[] = {
	FLAG("CA", 1),
	FLAG("EE", 2),
	FLAG("IAD", 0),
	MEASURED("VAD", FLOAT, DS2438_VAD, DS2438_VAD_VOLTS),
	MEASURED("VDD", FLOAT, DS2438_VDD, DS2438_VDD_VOLTS),
	TIMES,
	DS2438_LATEST(128),
	PROPERTY_DIR("pages"),
	DS2438_PAGES,
	MEASURED("temperature", TEMPERATURE, DS2438_TEMPERATURE, DS2438_CELSIUS(128)),
	TIME("udate", UNSIGNED, SECOND, 8),
	MEASURED("vis", FLOAT, DS2438_VIS, DS2438_VIS_VOLTS),
};

CHIP_FAMILY(1e, "DS2437", PRESENCE, .flags = FLAG_VOLT | FLAG_TEMPERATURE,
            SCAN({"temperature", "temperature"}, {"VDD", "vdd"}, {"VAD", "vad"}), AREAS(areas),
            HOW(how), PROPERTIES(ds2437));
