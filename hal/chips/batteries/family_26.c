/* SPDX-License-Identifier: MIT */
/*
 * DS2438 (data sheet 19-5099): temperature, two voltages, a current, a clock. ds2438.c reads and
 * writes its memory, ds2438_measure.c measures; what stands on boards with this chip (humidity,
 * pressure, light) is computed in sensors_26.c.
 *
 * TMP1826 and TMP1827 answer with the same family code: tmp1826.c tells them apart before anything
 * else is asked of a chip, and reads them.
 */
#include <errno.h>
#include <math.h>
#include <string.h>

#include "hal/chips/batteries/ds2438.h"
#include "hal/chips/batteries/ds2438_measure.h"
#include "hal/chips/batteries/sensors_26.h"
#include "hal/chips/family.h"
#include "hal/chips/identity.h"
#include "hal/chips/thermometers/tmp1826.h"
#include "hal/chips/thermometers/tmp1826_memory.h"
#include "hal/chips/thermometers/tmp1826_settings.h"

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

#define MEASURED(text, kind, what, ...) DS2438_MEASURED(text, kind, what, WAYS, __VA_ARGS__)
#define FLAG(text, bit) DS2438_FLAG(text, bit, WAYS)
#define TIME(text, kind, life_, where) DS2438_TIME(text, kind, life_, where, WAYS)

enum { PAGES = 1, MEMORY };
static const struct area *const areas[] = {[PAGES] = &ds2438_pages, [MEMORY] = &tmp1826_memory};

/* The same row serves both. */
static int read_temperature(struct txn *txn)
{
	return txn->device->kind == IS_TMP1826 ? tmp1826_read_temperature(txn)
	                                       : ds2438_read_measured(txn);
}

enum {
	WAYS = AFTER_SENSOR_WAYS,
	WAY_OFFSET = WAYS + DS2438_WAY_COUNT,
	WAY_IDENTITY,
	WAY_TEMPERATURE,
	WAY_LIMIT,
	WAY_POWER,
	WAY_FORMAT,
	WAY_ALERT,
};

/* The chips are told apart before anything is asked of them. */
static int read_identity(struct txn *txn)
{
	return property_text(txn, family_type(txn->device));
}

static const struct property_how how[] = {
	SENSOR_WAYS,
	DS2438_WAYS(WAYS),
	[WAY_OFFSET] = {.read = read_offset, .write = write_offset},
	[WAY_IDENTITY] = {.read = read_identity},
	[WAY_TEMPERATURE] = {.read = read_temperature},
	[WAY_LIMIT] = {.read = tmp1826_read_limit, .write = tmp1826_write_limit},
	[WAY_POWER] = {.read = tmp1826_read_power},
	[WAY_FORMAT] = {.read = tmp1826_read_format},
	[WAY_ALERT] = {.read = tmp1826_read_alert, .write = tmp1826_write_alert},
};

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
	TIME("date", DATE, VOLATILE, 8),
	PROPERTY_DIR("disconnect"),
	TIME("disconnect/date", DATE, VOLATILE, 16),
	TIME("disconnect/udate", UNSIGNED, VOLATILE, 16),
	PROPERTY_DIR("endcharge"),
	TIME("endcharge/date", DATE, VOLATILE, 20),
	TIME("endcharge/udate", UNSIGNED, VOLATILE, 20),
	DS2438_HUMIDITY("humidity", HIH3600),
	IDENTITY_ROW(WAY_IDENTITY, .kinds = KIND(IS_DS2438) | KIND(IS_TMP1826) | KIND(IS_NEITHER)),
	DS2438_LATEST(151, WAYS),
	OTHER("memory", BINARY, VOLATILE, BOTH, .size = 256, FIELD(MEMORY)),
	PROPERTY("offset", UNSIGNED, STABLE, BOTH, .negative = true, .how = WAY_OFFSET),
	PROPERTY_DIR("pages"),
	DS2438_PAGES(WAYS),
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
