/* SPDX-License-Identifier: MIT */
/*
 * UVI meter of Hobby Boards. No manual could be had: the commands are those of OWFS's driver, the
 * ones that write too, which it does not send; the offset is signed.
 */
#include <errno.h>

#include "hal/chips/field.h"
#include "hal/chips/makers/hobby_boards.h"

/* All ones: there is no measurement. */
static int saw_uvi(struct txn *txn, unsigned at, uint8_t *bytes, unsigned n)
{
	(void)txn, (void)at, (void)n;
	return bytes[0] == 0xff ? -EIO : 0;
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

enum { TEMPERATURE = AFTER_HOBBY_AREAS, TEMPERATURE_OFFSET, UVI_VALUE, UVI_OFFSET, IN_CASE };
static const struct area *const areas[] = {
	HOBBY_AREAS,
	[TEMPERATURE] = AREA(HOBBY_VALUE("temperature", 2, 0x21)),
	[TEMPERATURE_OFFSET] = AREA(HOBBY_SETTING("temperature offset", 2, 0x23, 0x22)),
	[UVI_VALUE] = AREA(.name = "UVI", .size = 1, .block = 1, .read = 0x24, .saw = saw_uvi),
	[UVI_OFFSET] = &uvi_offset,
	[IN_CASE] = &in_case,
};

enum { WAY_UVI = AFTER_HOBBY_WAYS };
static const struct property_how how[] = {HOBBY_WAYS, [WAY_UVI] = {.read = read_uvi}};

#define METER .kinds = KIND(HOBBY_UVI)

static const struct property properties[] = {
	PROPERTY("UVI", DIRECTORY, STATIC, NONE, METER),
	PROPERTY("UVI/UVI", FLOAT, VOLATILE, READ, METER, FIELD(UVI_VALUE, .unit = 0.1),
                 MEASURES(0, 25.5, 1, ""), .how = WAY_UVI),
	PROPERTY("UVI/UVI_offset", FLOAT, STABLE, BOTH, METER,
                 FIELD(UVI_OFFSET, .is_signed = true, .unit = 0.1), IN_UNIT("")),
	PROPERTY("UVI/in_case", YESNO, STABLE, BOTH, METER, FIELD(IN_CASE, .unit = 1 / 255.0)),
	PROPERTY("temperature", TEMPERATURE, VOLATILE, READ, METER,
                 FIELD(TEMPERATURE, .bytes = 2, .is_signed = true, .unit = 0.5), HOBBY_CELSIUS),
	PROPERTY("temperature_offset", TEMPGAP, STABLE, BOTH, METER,
                 FIELD(TEMPERATURE_OFFSET, .bytes = 2, .is_signed = true, .unit = 0.5)),
	PROPERTY("type", ASCII, VOLATILE, READ, .size = 32, .how = WAY_HOBBY_TYPE),
	PROPERTY("type_number", UNSIGNED, STABLE, READ, FIELD(HOBBY_TYPE)),
	PROPERTY("version", ASCII, STABLE, READ, .size = 7, .how = WAY_HOBBY_VERSION),
	PROPERTY("version_number", UNSIGNED, STABLE, READ, .hidden = true,
                 FIELD(HOBBY_VERSION, .bytes = 2)),
};

static const char *const types[] = HOBBY_TYPES("HobbyBoards_EE");

CHIP_FAMILY(ee, "HobbyBoards_EE", PRESENCE, .several = true, .identify = hobby_identify,
            .types = types, SCAN({"UVI/UVI", "uvi"}, {"temperature", "temperature"}), AREAS(areas),
            HOW(how), PROPERTIES(properties));
