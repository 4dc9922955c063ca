/* SPDX-License-Identifier: MIT */
/* DS1963L (data sheet 021704): 4 kbit of RAM with a battery, and counters of its writes. */
#include "hal/chips/family.h"
#include "hal/chips/memories/counter.h"

#define FIRST_COUNTED 12

static AREA_NAMED(memory, "memory", .size = 512, .address_bytes = 2, .read = 0xf0, .row = 32,
                  .write = 0x0f, .verify = 0xaa, .copy = 0x5a, .copy_ns = TXN_MS);

enum { MEMORY = 1, COUNTS };
static const struct area *const areas[] = {[MEMORY] = &memory, [COUNTS] = &counter_area};

enum { WAY_PAGE_COUNT = 1 };
static const struct property_how how[] = {[WAY_PAGE_COUNT] = {.read = counter_read_page}};

static const struct property properties[] = {
	AREA_MEMORY(MEMORY, 512),
	PROPERTY_DIR("pages"),
	PAGE_COUNTERS(COUNTS, FIRST_COUNTED, WAY_PAGE_COUNT),
	AREA_PAGES(MEMORY, 16, 32),
};

CHIP_FAMILY(1a, "DS1963L", PRESENCE, .flags = FLAG_OVERDRIVE, AREAS(areas), HOW(how),
            PROPERTIES(properties));
