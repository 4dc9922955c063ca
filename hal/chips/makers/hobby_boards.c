/* SPDX-License-Identifier: MIT */
/*
 * Boards of Hobby Boards: UVI meter (family EE), moisture meter, hub, barometer, hygrometer, six
 * thermometers (EF). A command for each value, its bytes without a checksum; one of them says which
 * board it is, and so which properties it has. No manual could be had: the commands are those of
 * OWFS's driver, the ones that write too, which it does not send to UVI meter, barometer,
 * hygrometer and thermometers; the offset of the UVI meter is signed.
 *
 * With one bit turned over, the command of a value is the one that writes the setting, and what it
 * writes are the ones of the read slots. So each is looked at three times, and a setting of all
 * ones is refused, and so is a UVI whose offset is all ones. A setting is read back; a bit turned
 * over in its command reaches another setting.
 */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "hal/chips/field.h"

/* The kinds (device.kind) are the numbers that the boards have themselves. */
enum hobby_kind {
	HOBBY_UNKNOWN,
	HOBBY_UVI,
	HOBBY_MOISTURE,
	HOBBY_LOGGER,
	HOBBY_SNIFFER,
	HOBBY_HUB,
	HOBBY_BAROMETER,
	HOBBY_HUMIDITY,
	HOBBY_MULTITEMP = 9,
	HOBBY_OTHER,
};
struct hobby {
	uint16_t version; /* major, minor; 0: not known */
};

/* Names of the kinds; of those that OWFS has no name for, that of the family. */
#define HOBBY_TYPES(own) \
	{ \
		own, "HB_UVI_METER", "HB_MOISTURE_METER", "HB_MOISTURE_METER_DATALOGGER", \
			"HB_SNIFFER", "HB_HUB", own, own, own, "HB_MULTITEMP", own \
	}
/*
 * Areas: what is read, and a setting. A read command that loses one bit on its way is the command
 * that writes the same setting, and the read slots after it are ones. So a setting that is all ones
 * proves nothing.
 */
#define HOBBY_VALUE(text, bytes_, command) \
	.name = (text), .size = (bytes_), .block = (bytes_), .read = (command)
#define HOBBY_SETTING(text, bytes_, get, put) \
	.name = (text), .size = (bytes_), .block = (bytes_), .read = (get), .row = (bytes_), \
	.write = (put), .ones_lie = true
/* Semiconductors: as widely as any of them measures. */
#define HOBBY_CELSIUS MEASURES(-58, 128, 1, DEGREES_C)

static const struct area hobby_type = {HOBBY_VALUE("type", 1, 0x12)};
static const struct area hobby_version = {HOBBY_VALUE("version", 2, 0x11)};

/* All ones: the board is not ready, or none is there. */
static int hobby_identify(struct txn *txn)
{
	uint8_t kind;
	int err = area_read(txn, &hobby_type, 0, &kind, 1);

	if (err)
		return err;
	if (kind == 0xff)
		return -EBADMSG;
	txn->device->kind = kind > 0 && kind < HOBBY_OTHER ? kind : HOBBY_OTHER;
	return 0;
}

static int hobby_read_text(struct txn *txn)
{
	char text[AREA_UNIT + 1] = {0};
	int err = area_read(txn, family_area(txn), 0, (uint8_t *)text, family_area(txn)->size);

	return err ? err : property_text(txn, text);
}

/* The last byte is the end of the text. */
static int hobby_write_text(struct txn *txn)
{
	const struct area *area = family_area(txn);
	uint8_t text[AREA_UNIT] = {0};

	if (txn->at || txn->len >= area->size)
		return -EINVAL;
	memcpy(text, txn->data, txn->len);
	return area_write(txn, area, 0, text, NULL, area->size);
}

static int hobby_read_type(struct txn *txn)
{
	int err = hobby_identify(txn);

	return err ? err : property_text(txn, family_type(txn->device));
}

static int hobby_read_version(struct txn *txn)
{
	uint8_t version[2];
	char text[8];
	int err = area_read(txn, &hobby_version, 0, version, 2);

	if (err)
		return err;
	snprintf(text, sizeof(text), "%u.%u", version[1], version[0]);
	return property_text(txn, text);
}

/* Written as all ones or zeros; any bit is a yes. */
static int saw_in_case(struct txn *txn, unsigned at, uint8_t *bytes, unsigned n)
{
	(void)txn, (void)at, (void)n;
	bytes[0] = bytes[0] ? 0xff : 0;
	return 0;
}

static const struct area uvi_offset = {HOBBY_SETTING("UVI offset", 1, 0x26, 0x25)};
static AREA_NAMED(in_case, "in case", .size = 1, .block = 1, .read = 0x28, .row = 1, .write = 0x27,
                  .saw = saw_in_case);

/* A disturbed read of it may have written the offset that the chip adds. */
static int read_uvi(struct txn *txn)
{
	uint8_t offset;
	int err;

	if (txn->phase == 0) {
		err = field_read(txn);
		if (err)
			return err;
		txn->phase = 1;
		return TXN_MORE;
	}
	return area_read(txn, &uvi_offset, 0, &offset, 1);
}

#define VERSION_1_80 (1 << 8 | 80) /* of a moisture meter: other commands from here on */
#define SINGLE_CHANNEL 0x02        /* of the hub's settings */

static const struct area leaf[] = {{HOBBY_SETTING("leaf", 1, 0x23, 0x22)},
                                   {HOBBY_SETTING("leaf", 1, 0x22, 0xa2)}};
static const struct area leaf_max[] = {{HOBBY_SETTING("leaf maximum", 2, 0x25, 0x24)},
                                       {HOBBY_SETTING("leaf maximum", 2, 0x23, 0xa3)}};
static const struct area leaf_min[] = {{HOBBY_SETTING("leaf minimum", 2, 0x27, 0x26)},
                                       {HOBBY_SETTING("leaf minimum", 2, 0x24, 0xa4)}};

static const struct area hub_config = {HOBBY_SETTING("hub config", 1, 0x61, 0x60)};

/* Some are switched on, the others off. */
static int store_branches(struct txn *txn, const struct area *area, unsigned at,
                          const uint8_t *bytes, unsigned n)
{
	const uint8_t on[] = {0x21, (uint8_t)(0x10 | bytes[0])};
	const uint8_t off[] = {0x21, (uint8_t)(~bytes[0] & 0x0f)};
	int err = txn_command(txn, on, sizeof(on));

	(void)area, (void)at, (void)n;
	return err ? err : txn_command(txn, off, sizeof(off));
}

static AREA_NAMED(branches, "branches", .size = 1, .block = 1, .read = 0x22, .row = 1,
                  .store = store_branches, .counts = 0x0f, .ones_lie = true);

/* Several at once take the hub out of its mode with one alone. */
static int write_branches(struct txn *txn)
{
	static const uint8_t zero = 0, single = SINGLE_CHANNEL;
	const uint8_t on = txn->bits & 0x0f, mask = 0x0f;

	if (txn->phase == 0 && (on & (on - 1))) {
		int err = area_write(txn, &hub_config, 0, &zero, &single, 1);
		if (err)
			return err;
		txn->phase = 1;
		return TXN_MORE;
	}
	txn->phase = 1;
	return area_write(txn, &branches, 0, &on, &mask, 1);
}

/* 0: the board's version is known. */
static int learn_version(struct txn *txn)
{
	struct hobby *board = txn->device->own;
	uint8_t bytes[2];

	if (board->version)
		return 0;
	int err = area_read(txn, &hobby_version, 0, bytes, 2);
	if (err)
		return err;
	board->version = (uint16_t)(bytes[0] | bytes[1] << 8);
	if (board->version == 0 || board->version == 0xffff) {
		board->version = 0;
		return -EBADMSG;
	}
	return TXN_MORE;
}

static const struct area *of_version(const struct txn *txn, const struct area areas[2])
{
	return &areas[((const struct hobby *)txn->device->own)->version >= VERSION_1_80];
}

/* arg: what a set bit is turned over with: of a leaf's sensor it is 1. */
static int read_leaf(struct txn *txn)
{
	uint8_t byte;
	int err = learn_version(txn);

	if (!err)
		err = area_read(txn, of_version(txn, leaf), 0, &byte, 1);
	if (!err)
		txn->bits = (byte ^ (unsigned)txn->property->arg) & 0x0f;
	return err;
}

static int write_leaf(struct txn *txn)
{
	const uint8_t byte = (txn->bits ^ (unsigned)txn->property->arg) & 0x0f, mask = 0x0f;
	int err = learn_version(txn);

	return err ? err : area_write(txn, of_version(txn, leaf), 0, &byte, &mask, 1);
}

static const struct area *limit(const struct txn *txn)
{
	return of_version(txn, txn->property->arg ? leaf_max : leaf_min);
}

static int read_limit(struct txn *txn)
{
	uint8_t bytes[2];
	int err = learn_version(txn);

	if (!err)
		err = area_read(txn, limit(txn), 0, bytes, 2);
	if (!err)
		txn->number[0] = bytes[0] | bytes[1] << 8;
	return err;
}

static int write_limit(struct txn *txn)
{
	unsigned value = txn->number[0] < 0xffff ? (unsigned)txn->number[0] : 0xffff;
	const uint8_t bytes[] = {(uint8_t)value, (uint8_t)(value >> 8)};
	int err = learn_version(txn);

	if (err)
		return err;
	return value == 0xffff ? -EINVAL : area_write(txn, limit(txn), 0, bytes, NULL, 2);
}

/* Nothing shows that it was done. */
static int write_command(struct txn *txn)
{
	return txn->number[0] != 0 ? txn_command(txn, TXN_BYTES((uint8_t)txn->property->arg)) : 0;
}

/* Name and area. */
#define HOBBY_AREAS(X) \
	X(TYPE, &hobby_type) \
	X(VERSION, &hobby_version) \
	X(UVI_TEMPERATURE, AREA(HOBBY_VALUE("temperature", 2, 0x21))) \
	X(TEMPERATURE_OFFSET, AREA(HOBBY_SETTING("temperature offset", 2, 0x23, 0x22))) \
	/* all ones: there is no measurement */ \
	X(UVI_VALUE, AREA(HOBBY_VALUE("UVI", 1, 0x24), .ones_lie = true)) \
	X(UVI_OFFSET, &uvi_offset) \
	X(IN_CASE, &in_case) \
	X(POLLING, AREA(HOBBY_SETTING("polling frequency", 1, 0x14, 0x94))) \
	X(AVAILABLE, AREA(HOBBY_VALUE("polling frequencies", 1, 0x15))) \
	X(LOCATION, AREA(HOBBY_SETTING("location", 21, 0x16, 0x96))) \
	X(CONFIG, AREA(HOBBY_SETTING("config", 1, 0x61, 0xe1))) \
	X(TEMPERATURE, AREA(HOBBY_VALUE("temperature", 2, 0x40))) \
	X(PRESSURE, AREA(HOBBY_VALUE("pressure", 2, 0x22))) \
	X(PRESSURE_ALTITUDE, AREA(HOBBY_VALUE("pressure altitude", 2, 0x24))) \
	X(ALTITUDE, AREA(HOBBY_SETTING("altitude", 2, 0x26, 0xa6))) \
	X(CORRECTED, AREA(HOBBY_VALUE("humidity", 2, 0x21))) \
	X(UNCORRECTED, AREA(HOBBY_VALUE("raw humidity", 2, 0x22))) \
	X(HUMIDITY_OFFSET, AREA(HOBBY_SETTING("humidity offset", 2, 0x24, 0xa4))) \
	X(TEMPERATURES, AREA(HOBBY_VALUE("temperatures", 12, 0x21))) \
	X(SENSORS, AREA(HOBBY_VALUE("sensors", 4, 0x21))) \
	X(RAW, AREA(HOBBY_VALUE("raw", 8, 0x31))) \
	X(HUB_CONFIG, &hub_config) \
	X(SHORTED, AREA(HOBBY_VALUE("shorted", 1, 0x23))) \
	X(BRANCHES, &branches)
#define AREA_ENUM(name, ...) name,
#define AREA_OF(name, ...) [name] = __VA_ARGS__,
enum { NO_AREA, HOBBY_AREAS(AREA_ENUM) };
static const struct area *const areas[] = {HOBBY_AREAS(AREA_OF)};

enum { WAY_TEXT = 1, WAY_TYPE, WAY_VERSION, WAY_UVI, WAY_BRANCH, WAY_LEAF, WAY_LIMIT, WAY_COMMAND };
static const struct property_how how[] = {
	[WAY_TEXT] = {.read = hobby_read_text, .write = hobby_write_text},
	[WAY_TYPE] = {.read = hobby_read_type},
	[WAY_VERSION] = {.read = hobby_read_version},
	[WAY_UVI] = {.read = read_uvi},
	[WAY_BRANCH] = {.write = write_branches},
	[WAY_LEAF] = {.read = read_leaf, .write = write_leaf},
	[WAY_LIMIT] = {.read = read_limit, .write = write_limit},
	[WAY_COMMAND] = {.write = write_command},
};

/* clang-format off */
#define PERCENT MEASURES(-10, 110, 2, "%")
#define OF(board) .kinds = KIND(HOBBY_##board)
#define FOLDER(text, board) PROPERTY(text, DIRECTORY, STATIC, NONE, OF(board))
/* A value of two bytes. */
#define VALUE(text, kind, board, area_, unit_, measures_) \
	PROPERTY(text, kind, VOLATILE, READ, OF(board), measures_, \
	         FIELD(area_, .bytes = 2, .is_signed = true, .unit = (unit_)))
#define SETTING(text, kind, life_, board, area_, unit_, measures_) \
	PROPERTY(text, kind, life_, BOTH, OF(board), measures_, \
	         FIELD(area_, .bytes = 2, .is_signed = true, .unit = (unit_)))
#define BYTE(text, access_, board, area_) \
	PROPERTY(text, UNSIGNED, STABLE, access_, OF(board), FIELD(area_))
#define TEXT(text, board) \
	PROPERTY(text, ASCII, STABLE, BOTH, OF(board), .size = 21, FIELD(LOCATION), \
	         .how = WAY_TEXT)
#define COMMAND(text, board, code_) \
	PROPERTY(text, YESNO, STABLE, WRITE, OF(board), .arg = (code_), .how = WAY_COMMAND)

/* What all have; the life of the version is as owserver has it. */
#define TYPES(life_) \
	PROPERTY("type", ASCII, VOLATILE, READ, .size = 32, .how = WAY_TYPE), \
	PROPERTY("type_number", UNSIGNED, STABLE, READ, FIELD(TYPE)), \
	PROPERTY("version", ASCII, life_, READ, .size = 7, .how = WAY_VERSION), \
	PROPERTY("version_number", UNSIGNED, STABLE, READ, .hidden = true, \
	         FIELD(VERSION, .bytes = 2))

static const struct property uvi_properties[] = {
	PROPERTY("UVI", DIRECTORY, STATIC, NONE, OF(UVI)),
	PROPERTY("UVI/UVI", FLOAT, VOLATILE, READ, OF(UVI), FIELD(UVI_VALUE, .unit = 0.1),
                 MEASURES(0, 25.5, 1, ""), .how = WAY_UVI),
	PROPERTY("UVI/UVI_offset", FLOAT, STABLE, BOTH, OF(UVI),
                 FIELD(UVI_OFFSET, .is_signed = true, .unit = 0.1), IN_UNIT("")),
	PROPERTY("UVI/in_case", YESNO, STABLE, BOTH, OF(UVI), FIELD(IN_CASE, .unit = 1 / 255.0)),
	PROPERTY("temperature", TEMPERATURE, VOLATILE, READ, OF(UVI),
                 FIELD(UVI_TEMPERATURE, .bytes = 2, .is_signed = true, .unit = 0.5), HOBBY_CELSIUS),
	PROPERTY("temperature_offset", TEMPGAP, STABLE, BOTH, OF(UVI),
                 FIELD(TEMPERATURE_OFFSET, .bytes = 2, .is_signed = true, .unit = 0.5)),
	TYPES(STABLE),
};

static const struct property properties[] = {
	FOLDER("barometer", BAROMETER),
	SETTING("barometer/altitude", INTEGER, VOLATILE, BAROMETER, ALTITUDE, 1, IN_UNIT("m")),
	BYTE("barometer/config", BOTH, BAROMETER, CONFIG),
	TEXT("barometer/location", BAROMETER),
	BYTE("barometer/polling_available", READ, BAROMETER, AVAILABLE),
	BYTE("barometer/polling_frequency", BOTH, BAROMETER, POLLING),
	VALUE("barometer/pressure", PRESSURE, BAROMETER, PRESSURE, 10, MEASURES(10, 1300, 0, "mbar")),
	VALUE("barometer/pressure_altitude", INTEGER, BAROMETER, PRESSURE_ALTITUDE, 1, IN_UNIT("m")),
	COMMAND("barometer/reboot", BAROMETER, 0xf1),
	COMMAND("barometer/reset", BAROMETER, 0xf7),
	VALUE("barometer/temperature", TEMPERATURE, BAROMETER, TEMPERATURE, 0.1, HOBBY_CELSIUS),
	FOLDER("hub", HUB),
	PROPERTY("hub/branch", BITS, STABLE, BOTH, AGGREGATE(4, NUMBERS), OF(HUB),
	         FIELD(BRANCHES), .holds = true, .how = WAY_BRANCH),
	PROPERTY("hub/config", UNSIGNED, VOLATILE, BOTH, .hidden = true, OF(HUB),
	         FIELD(HUB_CONFIG)),
	PROPERTY("hub/short", BITS, STABLE, READ, AGGREGATE(4, NUMBERS), OF(HUB), FIELD(SHORTED)),
	FOLDER("humidity", HUMIDITY),
	BYTE("humidity/config", BOTH, HUMIDITY, CONFIG),
	VALUE("humidity/humidity_corrected", FLOAT, HUMIDITY, CORRECTED, 0.01, PERCENT),
	SETTING("humidity/humidity_offset", FLOAT, VOLATILE, HUMIDITY, HUMIDITY_OFFSET, 0.01,
	        IN_UNIT("%")),
	VALUE("humidity/humidity_raw", FLOAT, HUMIDITY, UNCORRECTED, 0.01, PERCENT),
	TEXT("humidity/location", HUMIDITY),
	BYTE("humidity/polling_available", READ, HUMIDITY, AVAILABLE),
	BYTE("humidity/polling_frequency", BOTH, HUMIDITY, POLLING),
	COMMAND("humidity/reboot", HUMIDITY, 0xf1),
	COMMAND("humidity/reset", HUMIDITY, 0xf7),
	VALUE("humidity/temperature", TEMPERATURE, HUMIDITY, TEMPERATURE, 0.1, HOBBY_CELSIUS),
	FOLDER("moisture", MOISTURE),
	FOLDER("moisture/calibrate", MOISTURE),
	PROPERTY("moisture/calibrate/max", UNSIGNED, STABLE, BOTH, OF(MOISTURE), .arg = 1,
	         COUNTS_TO(UINT16_MAX), .how = WAY_LIMIT),
	PROPERTY("moisture/calibrate/min", UNSIGNED, STABLE, BOTH, OF(MOISTURE), .arg = 0,
	         COUNTS_TO(UINT16_MAX), .how = WAY_LIMIT),
	PROPERTY("moisture/calibrate/raw", UNSIGNED, VOLATILE, READ, AGGREGATE(4, NUMBERS),
	         OF(MOISTURE), FIELD(RAW, .bytes = 2, .stride = 2), COUNTS_TO(UINT16_MAX)),
	PROPERTY("moisture/is_leaf", BITS, VOLATILE, BOTH, AGGREGATE(4, NUMBERS), OF(MOISTURE),
	         .arg = 0x00, .how = WAY_LEAF),
	PROPERTY("moisture/is_moisture", BITS, STABLE, BOTH, AGGREGATE(4, NUMBERS), OF(MOISTURE),
	         .arg = 0x0f, .how = WAY_LEAF),
	PROPERTY("moisture/sensor", INTEGER, VOLATILE, READ, AGGREGATE(4, NUMBERS), OF(MOISTURE),
	         FIELD(SENSORS, .stride = 1), COUNTS_TO(UINT8_MAX)),
	FOLDER("multitemp", MULTITEMP),
	BYTE("multitemp/config", READ, MULTITEMP, CONFIG),
	TEXT("multitemp/location", MULTITEMP),
	BYTE("multitemp/polling_available", READ, MULTITEMP, AVAILABLE),
	BYTE("multitemp/polling_frequency", BOTH, MULTITEMP, POLLING),
	COMMAND("multitemp/reboot", MULTITEMP, 0xf1),
	COMMAND("multitemp/reset", MULTITEMP, 0xf7),
	PROPERTY("multitemp/temperature", TEMPERATURE, VOLATILE, READ, AGGREGATE(6, NUMBERS),
	         OF(MULTITEMP),
	         FIELD(TEMPERATURES, .bytes = 2, .stride = 2, .is_signed = true, .unit = 0.1),
	         HOBBY_CELSIUS),
	TYPES(VOLATILE),
};
/* clang-format on */

static const char *const uvi_types[] = HOBBY_TYPES("HobbyBoards_EE");
static const char *const types[] = HOBBY_TYPES("HobbyBoards_EF");

CHIP_FAMILY(ee, "HobbyBoards_EE", PRESENCE, .several = true, .identify = hobby_identify,
            .types = uvi_types, SCAN({"UVI/UVI", "uvi"}, {"temperature", "temperature"}),
            AREAS(areas), HOW(how), PROPERTIES(uvi_properties));

CHIP_FAMILY(ef, "HobbyBoards_EF", PRESENCE, .several = true, .identify = hobby_identify,
            .types = types,
            SCAN({"barometer/pressure", "pressure"}, {"barometer/temperature", "temperature"},
                 {"humidity/humidity_corrected", "humidity"},
                 {"humidity/temperature", "temperature"}, {"moisture/sensor", "moisture"},
                 {"multitemp/temperature", "temperature"}),
            AREAS(areas), HOW(how), PROPERTIES(properties));
