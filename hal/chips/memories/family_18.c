/* SPDX-License-Identifier: MIT */
/*
 * DS1963S (data sheet, "SHA iButton"): 4 kbit of RAM with a battery, which counts how often it is
 * written. Its secrets are not written here.
 */
#include "hal/chips/family.h"
#include "hal/chips/memories/counter.h"

#define FIRST_COUNTED 8
#define ERASE_SCRATCHPAD 0xc3

/* What the chip has computed hides the scratchpad until it is erased. */
static int store_row(struct txn *txn, const struct area *area, unsigned at, const uint8_t *bytes,
                     unsigned n)
{
	static const uint8_t erase[] = {ERASE_SCRATCHPAD, 0, 0};
	uint8_t command[3 + AREA_UNIT] = {area->write, (uint8_t)at, (uint8_t)(at >> 8)};
	int err = txn_command(txn, erase, sizeof(erase));

	for (unsigned i = 0; i < n; i++)
		command[3 + i] = bytes[i];
	return err ? err : txn_command(txn, command, 3 + n);
}

static AREA_NAMED(memory, "memory", .size = 512, .address_bytes = 2, .read = 0xf0, .row = 32,
                  .write = 0x0f, .verify = 0xaa, .copy = 0x55, .copy_ns = TXN_MS,
                  .store = store_row);

enum { MEMORY = 1, COUNTS };
static const struct area *const areas[] = {[MEMORY] = &memory, [COUNTS] = &counter_area};

enum { WAY_SECRET = 1, WAY_PAGE_COUNT };
static const struct property_how how[] = {
	[WAY_SECRET] = {.write = property_refuse},
	[WAY_PAGE_COUNT] = {.read = counter_read_page},
};

#define SECRET(text) PROPERTY(text, BINARY, STABLE, WRITE, .size = 8, .how = WAY_SECRET)

static const struct property properties[] = {
	AREA_MEMORY(MEMORY, 512),
	PROPERTY_DIR("pages"),
	PAGE_COUNTERS(COUNTS, FIRST_COUNTED, WAY_PAGE_COUNT),
	AREA_PAGES(MEMORY, 16, 32),
	SECRET("pages/password"),
	SECRET("password"),
};

CHIP_FAMILY(18, "DS1963S", PRESENCE, .flags = FLAG_RESUME | FLAG_OVERDRIVE, AREAS(areas), HOW(how),
            PROPERTIES(properties));
