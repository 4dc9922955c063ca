/* SPDX-License-Identifier: MIT */
/*
 * Sensors of CMC Industrial Electronics: rotation mRS001, alternating current mCM001, four
 * fail-safe contacts mDI001, analog input mAM001. Each has measured a word of 16 bits. No data
 * sheet could be had: the command is that of OWFS's driver.
 *
 * The word has a CRC8, and in an mDI001 bits that say what it is.
 */
#include <errno.h>

#include "hal/chips/family.h"

#define WORD .size = 3, .block = 3, .read = 0xbe, .check = AREA_CRC8

static AREA_NAMED(reading, "reading", WORD);

/* Of the contacts: what the word is about stands in its upper four bits. */
static int saw_status(struct txn *txn, unsigned at, uint8_t *bytes, unsigned n)
{
	(void)txn, (void)at, (void)n;
	return (bytes[1] & 0xf0) == 0x80 ? 0 : -EIO;
}

enum { READING = 1, STATUS };
static const struct area *const areas[] = {
	[READING] = &reading, [STATUS] = AREA(.name = "status", WORD, .saw = saw_status)};

/* Below zero in reverse, though the property is unsigned: owserver says 4294967295 for -1. */
static int read_rpm(struct txn *txn)
{
	uint8_t word[3];
	int err = area_read(txn, &reading, 0, word, sizeof(word));

	if (!err)
		txn->number[0] = (int16_t)(word[0] | word[1] << 8);
	return err;
}

enum { WAY_RPM = 1 };
static const struct property_how how[] = {[WAY_RPM] = {.read = read_rpm}};

/* clang-format off */
#define READING_ROW \
	PROPERTY("reading", UNSIGNED, VOLATILE, READ, .hidden = true, FIELD(READING, .bytes = 2))
#define MEASURED(text, unit_, ...) \
	PROPERTY(text, FLOAT, VOLATILE, READ, FIELD(READING, .bytes = 2, .unit = (unit_)), \
	         __VA_ARGS__)
/* Closed, loop shorted, loop open: four bits each. */
#define CONTACTS(text, shift_) \
	PROPERTY(text, BITS, VOLATILE, READ, AGGREGATE(4, NUMBERS), \
	         FIELD(STATUS, .bytes = 2, .shift = (shift_)))
#define NIBBLE(text, shift_) \
	PROPERTY(text, UNSIGNED, VOLATILE, READ, .hidden = true, \
	         FIELD(STATUS, .bytes = 2, .shift = (shift_), .bits = 4))

static const struct property rotation[] = {
	PROPERTY("RPM", UNSIGNED, VOLATILE, READ, MEASURES(INT16_MIN, INT16_MAX, 0, "rpm"),
	         .how = WAY_RPM),
	READING_ROW,
};
static const struct property alternating[] = {
	MEASURED("current", 0.01, MEASURES(0, 655.35, 2, "A")),
	READING_ROW,
};
static const struct property contacts[] = {
	CONTACTS("loop_open", 8),
	CONTACTS("loop_shorted", 4),
	NIBBLE("open", 8),
	READING_ROW,
	NIBBLE("shorted", 4),
	NIBBLE("switch", 0),
	CONTACTS("switch_closed", 0),
};
/* 10,000 is 10 V or 20 mA, as its switches are set. */
static const struct property analog[] = {
	MEASURED("current", 2e-6, MEASURES(0, .131072, 6, "A")),
	READING_ROW,
	MEASURED("volts", 0.001, MEASURES(0, 65.536, 3, "V")),
};
/* clang-format on */

CHIP_FAMILY(a0, "mRS001", PRESENCE, SCAN({"RPM", "rpm"}), AREAS(areas), HOW(how),
            PROPERTIES(rotation));
CHIP_FAMILY(a2, "mCM001", PRESENCE, SCAN({"current", "current"}), AREAS(areas),
            PROPERTIES(alternating));
CHIP_FAMILY(a5, "mDI001", PRESENCE,
            SCAN({"switch_closed.BYTE", "inputs"}, {"loop_open.BYTE", "opens"},
                 {"loop_shorted.BYTE", "shorts"}),
            AREAS(areas), PROPERTIES(contacts));
CHIP_FAMILY(b2, "mAM001", PRESENCE, SCAN({"volts", "volt"}, {"current", "current"}), AREAS(areas),
            PROPERTIES(analog));
