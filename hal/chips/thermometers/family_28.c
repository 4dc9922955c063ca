/* SPDX-License-Identifier: MIT */
/*
 * DS18B20 and MAX31820, and the clones of the DS18B20 by the families of Chris Petrich's catalogue
 * (github.com/cpetrich/counterfeit_DS18B20, 2024, whose letters these are): by the id, the reserved
 * bytes of the scratchpad, and the limits as the maker sets them, which a user may have changed.
 * Only Read Scratchpad is sent. What an id alone suggests may be wrong: ids of some
 * clones are random.
 *
 * Byte 6 after a conversion is, with the last four bits n of the temperature: 16 - n in the genuine
 * chip and families A2, A3, B1v2, E, H; 32 - n in G; constant in B1, B2, C, F, where a write
 * of the settings may change it.
 */
#include <errno.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include "hal/chips/family.h"
#include "hal/chips/thermometers/state.h"
#include "hal/chips/thermometers/thermometer.h"

#define CLONE "DS18B20 clone"
#define FAMILY_ CLONE ", family "
#define POWER_ON_6 0x0c
#define GENUINE_7 0x10

/* Families D1 and D2, by bytes 3 and 4 of the id. */
static const char *family_d(const uint8_t rom[8])
{
	static const uint8_t d1[][2] = {{0x77, 0x91}, {0x46, 0x92}};
	static const uint8_t d2[][2] = {{0x79, 0x97}, {0x94, 0x97}, {0x79, 0xa2},
	                                {0x16, 0xa8}, {0x56, 0xb5}, {0x07, 0xd6}};

	for (unsigned i = 0; i < sizeof(d1) / sizeof(d1[0]); i++)
		if (rom[3] == d1[i][0] && rom[4] == d1[i][1])
			return FAMILY_ "D1";
	for (unsigned i = 0; i < sizeof(d2) / sizeof(d2[0]); i++)
		if (rom[3] == d2[i][0] && rom[4] == d2[i][1])
			return FAMILY_ "D2";
	return FAMILY_ "D1 or D2";
}

static const char *constant(const uint8_t rom[8])
{
	if (rom[1] == 0xaa)
		return FAMILY_ "B1";
	if ((rom[1] == 0xff || rom[1] == 0x61) && rom[2] == 0x64)
		return FAMILY_ "C";
	return rom[1] == 0xff || rom[1] == 0xee ? FAMILY_ "B2" : FAMILY_ "B1, B2, C or F";
}

/* Byte 6 is that of the genuine chip. */
static const char *follows(const uint8_t rom[8], const uint8_t pad[9])
{
	if (!clone_has_id(rom))
		return rom[4] == 0 && pad[SP_HIGH] == 0x7f && pad[SP_LOW] == 0x80 ? FAMILY_ "A3"
		                                                                  : "DS18B20";
	if (clone_hides_restart(rom))
		return FAMILY_ "E";
	if (rom[1] == 0 || rom[2] == 0)
		return FAMILY_ "A2";
	return pad[SP_HIGH] == 0x55 && pad[SP_LOW] == 0xaa ? FAMILY_ "H" : FAMILY_ "B1v2 or H";
}

/* What a scratchpad shows; exact: it holds a result of 12 bits, not what a restart left. */
static const char *clone_name(const uint8_t rom[8], const uint8_t pad[9], bool exact)
{
	unsigned low = pad[SP_LSB] & 0xf;

	if (pad[SP_5] != 0xff)
		return family_d(rom);
	if (pad[SP_PER_DEGREE] != GENUINE_7)
		return FAMILY_ "B1 or B2"; /* whose bytes 6 and 7 are the user's */
	/* Both are 12 at n = 4. */
	if (!exact || low == 16 - POWER_ON_6)
		return clone_has_id(rom) ? CLONE : "DS18B20";
	if (pad[SP_REMAIN] == 16 - low)
		return follows(rom, pad);
	return pad[SP_REMAIN] == 32 - low ? FAMILY_ "G" : constant(rom);
}

/* The first look refuses what a restart left, which says nothing; the second sees the same. */
static int clone_read_identity(struct txn *txn)
{
	const struct thermometer *chip = txn->device->own;
	uint8_t pad[9];
	int err;

	if (txn->phase == 0) {
		err = thermometer_read_temperature(txn);
		txn->phase = 1;
		return err ? err : TXN_MORE;
	}
	err = thermometer_scratchpad(txn, pad);
	if (err)
		return err;
	if (memcmp(chip->latched, pad, 2) != 0 || chip->latched[2] != pad[SP_REMAIN])
		return -EBADMSG;
	bool exact = chip->resolution == 12;
	return property_text(txn, clone_name(txn->device->rom, pad, exact));
}

static const struct area *const areas[] = {THERMOMETER_AREAS};
enum { WAY_IDENTITY = AFTER_THERMOMETER_WAYS };
static const struct property_how how[] = {
	THERMOMETER_WAYS,
	[WAY_IDENTITY] = {.read = clone_read_identity},
};
static const struct property properties[] = {
	THERMOMETER_ERRATA,
	THERMOMETER_TEMPERATURE("fasttemp", 9, 1),
	IDENTITY_ROW(WAY_IDENTITY, .convert = CONVERT_TEMPRES),
	THERMOMETER_LATEST,
	THERMOMETER_POWER,
	THERMOMETER_SCRATCHPAD,
	THERMOMETER_TEMPERATURES,
};

CHIP_FAMILY(28, "DS18B20", PRESENCE, .flags = FLAG_ALARM | FLAG_TEMPERATURE,
            SCAN({"temperature12", "temperature"}), .name = clone_name, THERMOMETER_FAMILY,
            AREAS(areas), HOW(how), PROPERTIES(properties));
