/* SPDX-License-Identifier: MIT */
/* Four fail-safe contacts, mDI001: closed, loop shorted, loop open, four bits each. */
#include <errno.h>

#include "hal/chips/makers/cmciel.h"

/* What the word is about stands in its upper four bits. */
static int saw_status(struct txn *txn, unsigned at, uint8_t *bytes, unsigned n)
{
	(void)txn, (void)at, (void)n;
	return (bytes[1] & 0xf0) == 0x80 ? 0 : -EIO;
}

static AREA_NAMED(status, "status", .size = 3, .block = 3, .read = 0xbe, .check = AREA_CRC8,
                  .saw = saw_status);

enum { STATUS = READING + 1 };
static const struct area *const areas[] = {CMCIEL_AREAS, [STATUS] = &status};

#define CONTACTS(text, shift_) \
	PROPERTY(text, BITS, VOLATILE, READ, AGGREGATE(4, NUMBERS), \
	         FIELD(STATUS, .bytes = 2, .shift = (shift_)))
#define WORD(text, shift_) \
	PROPERTY(text, UNSIGNED, VOLATILE, READ, .hidden = true, \
	         FIELD(STATUS, .bytes = 2, .shift = (shift_), .bits = 4))

static const struct property properties[] = {
	CONTACTS("loop_open", 8),
	CONTACTS("loop_shorted", 4),
	WORD("open", 8),
	CMCIEL_READING,
	WORD("shorted", 4),
	WORD("switch", 0),
	CONTACTS("switch_closed", 0),
};

CHIP_FAMILY(a5, "mDI001", PRESENCE,
            SCAN({"switch_closed.BYTE", "inputs"}, {"loop_open.BYTE", "opens"},
                 {"loop_shorted.BYTE", "shorts"}),
            AREAS(areas), PROPERTIES(properties));
