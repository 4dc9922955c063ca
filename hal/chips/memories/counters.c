/* SPDX-License-Identifier: MIT */
/*
 * 4 kbit of RAM with a battery, and counters that belong to its pages: DS1963L (data sheet 021704)
 * and DS1963S ("SHA iButton", whose secrets are not written here) count their writes, DS2423
 * (19-5140) what happens at two pins as well.
 *
 * Read Memory + Counter has a CRC16. A scratchpad that Erase Scratchpad (DS1963S) did not reach
 * takes nothing: it is read back.
 */
#include <errno.h>
#include <string.h>

#include "hal/chips/field.h"

#define EXTERNAL_A 14 /* page of the first pin */
#define READ_COUNTER 0xa5
#define ERASE_SCRATCHPAD 0xc3

/*
 * Four bytes for each page, each read by a command of its own: from the page's last byte on that
 * byte, 32 bits of counter, 32 others, and the CRC16.
 */
static int counter_load(struct txn *txn, const struct area *area, unsigned at, uint8_t *bytes,
                        unsigned n)
{
	unsigned address = at / area->block * 32 + 31;
	uint8_t command[] = {READ_COUNTER, (uint8_t)address, (uint8_t)(address >> 8)}, in[9];
	int err = txn_ask_crc16(txn, command, sizeof(command), in, sizeof(in));

	if (!err)
		memcpy(bytes, in + 1, n);
	return err;
}

static AREA_NAMED(counters, "counters", .size = 64, .block = 4, .load = counter_load);

/* What the chip has computed hides the scratchpad until it is erased. */
static int store_row(struct txn *txn, const struct area *area, unsigned at, const uint8_t *bytes,
                     unsigned n)
{
	uint8_t command[3 + AREA_UNIT] = {area->write, (uint8_t)at, (uint8_t)(at >> 8)};
	int err = txn_command(txn, TXN_BYTES(ERASE_SCRATCHPAD, 0, 0));

	memcpy(command + 3, bytes, n);
	return err ? err : txn_command(txn, command, 3 + n);
}

/* Pages below arg have no counter, and the chip sends ones in its place. */
static int read_page_count(struct txn *txn)
{
	return txn->element < txn->property->arg ? -ENOENT : field_read(txn);
}

static int read_minimum(struct txn *txn)
{
	unsigned page = EXTERNAL_A + txn->phase;
	uint8_t in[4];
	int err = area_read(txn, &counters, page * 4, in, sizeof(in));

	if (err)
		return err;
	uint32_t count = area_le32(in);
	if (txn->phase++ == 0) {
		txn->number[0] = count;
		return TXN_MORE;
	}
	txn->number[0] = txn->number[0] < count ? txn->number[0] : count;
	return 0;
}

/* The counters cannot be set. */
static int write_minimum(struct txn *txn)
{
	(void)txn;
	return -EINVAL;
}

enum { MEMORY = 1, COUNTS };
#define RAM(copy_) \
	.name = "memory", .size = 512, .address_bytes = 2, .read = 0xf0, .row = 32, .write = 0x0f, \
	.verify = 0xaa, .copy = (copy_), .copy_ns = TXN_MS
static const struct area *const areas[] = {[MEMORY] = AREA(RAM(0x5a)), [COUNTS] = &counters};
static const struct area *const erased_areas[] = {
	[MEMORY] = AREA(RAM(0x55), .store = store_row), [COUNTS] = &counters};

enum { WAY_PAGE_COUNT = 1, WAY_MINIMUM, WAY_SECRET };
static const struct property_how how[] = {
	[WAY_PAGE_COUNT] = {.read = read_page_count},
	[WAY_MINIMUM] = {.read = read_minimum, .write = write_minimum},
	[WAY_SECRET] = {.write = property_refuse},
};

/* clang-format off */
#define COUNTERS(text, n, index_, page, ...) \
	PROPERTY(text, UNSIGNED, VOLATILE, READ, ELEMENTS(n, index_), \
	         FIELD(COUNTS, .at = 4 * (page), .stride = 4, .bytes = 4), COUNTS_TO(UINT32_MAX), \
	         __VA_ARGS__)
#define PAGES(first) \
	PROPERTY_DIR("pages"), \
	COUNTERS("pages/count", 16, NUMBERS, 0, .arg = (first), .how = WAY_PAGE_COUNT), \
	AREA_PAGES(MEMORY, 16, 32)
#define SECRET(text) PROPERTY(text, BINARY, STABLE, WRITE, .size = 8, .how = WAY_SECRET)

static const struct property ds1963s[] = {
	AREA_MEMORY(MEMORY, 512), PAGES(8), SECRET("pages/password"), SECRET("password"),
};
static const struct property ds1963l[] = {AREA_MEMORY(MEMORY, 512), PAGES(12)};
static const struct property ds2423[] = {
	COUNTERS("counter", 2, LETTERS, EXTERNAL_A, .hidden = false),
	COUNTERS("counters", 2, LETTERS, EXTERNAL_A, .hidden = true),
	AREA_MEMORY(MEMORY, 512),
	PROPERTY("mincount", UNSIGNED, VOLATILE, BOTH, COUNTS_TO(UINT32_MAX), .how = WAY_MINIMUM),
	PAGES(12),
};
/* clang-format on */

CHIP_FAMILY(18, "DS1963S", PRESENCE, .flags = FLAG_RESUME | FLAG_OVERDRIVE, AREAS(erased_areas),
            HOW(how), PROPERTIES(ds1963s));
CHIP_FAMILY(1a, "DS1963L", PRESENCE, .flags = FLAG_OVERDRIVE, AREAS(areas), HOW(how),
            PROPERTIES(ds1963l));
CHIP_FAMILY(1d, "DS2423", PRESENCE, .flags = FLAG_OVERDRIVE,
            SCAN({"counter.A", "counter_a"}, {"counter.B", "counter_b"}), AREAS(areas), HOW(how),
            PROPERTIES(ds2423));
