/* SPDX-License-Identifier: MIT */
/* DS2423 (data sheet 19-5140): 4 kbit of RAM, and counters on its last four pages. */
#include <errno.h>

#include "hal/chips/family.h"
#include "hal/chips/memories/counter.h"

#define FIRST_COUNTED 12
#define EXTERNAL_A 14

static AREA_NAMED(memory, "memory", .size = 512, .address_bytes = 2, .read = 0xf0, .row = 32,
                  .write = 0x0f, .verify = 0xaa, .copy = 0x5a, .copy_ns = TXN_MS);

static int read_minimum(struct txn *txn)
{
	unsigned page = EXTERNAL_A + txn->phase;
	uint8_t in[4];
	int err = area_read(txn, &counter_area, page * 4, in, sizeof(in));

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
static const struct area *const areas[] = {[MEMORY] = &memory, [COUNTS] = &counter_area};

enum { WAY_MINIMUM = 1, WAY_PAGE_COUNT };
static const struct property_how how[] = {
	[WAY_MINIMUM] = {.read = read_minimum, .write = write_minimum},
	[WAY_PAGE_COUNT] = {.read = counter_read_page},
};

static const struct property properties[] = {
	COUNTERS("counter", COUNTS, 2, LETTERS, EXTERNAL_A, .hidden = false),
	COUNTERS("counters", COUNTS, 2, LETTERS, EXTERNAL_A, .hidden = true),
	AREA_MEMORY(MEMORY, 512),
	PROPERTY("mincount", UNSIGNED, VOLATILE, BOTH, COUNTS_TO(UINT32_MAX), .how = WAY_MINIMUM),
	PROPERTY_DIR("pages"),
	PAGE_COUNTERS(COUNTS, FIRST_COUNTED, WAY_PAGE_COUNT),
	AREA_PAGES(MEMORY, 16, 32),
};

CHIP_FAMILY(1d, "DS2423", PRESENCE, .flags = FLAG_OVERDRIVE,
            SCAN({"counter.A", "counter_a"}, {"counter.B", "counter_b"}), AREAS(areas), HOW(how),
            PROPERTIES(properties));
