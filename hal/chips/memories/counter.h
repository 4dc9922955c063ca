/* SPDX-License-Identifier: MIT */
/* Counters that belong to the pages of a memory: DS2423, DS1963L, DS1963S. */
#pragma once

#include "hal/chips/family.h"

/* Four bytes for each page, each read by a command of its own with a checksum. */
extern const struct area counter_area;

#define COUNTERS(text, area_, n, index_, page, ...) \
	PROPERTY(text, UNSIGNED, VOLATILE, READ, ELEMENTS(n, index_), \
	         FIELD(area_, .at = 4 * (page), .stride = 4, .bytes = 4), COUNTS_TO(UINT32_MAX), \
	         __VA_ARGS__)

/*
 * The counters of all pages, a row of the table. Pages below `first` have none, and the chip sends
 * ones in its place: -ENOENT, without a look at the chip. way: {.read = counter_read_page}.
 */
#define PAGE_COUNTERS(area_, first, way) \
	COUNTERS("pages/count", area_, 16, NUMBERS, 0, .arg = (first), .how = (way))
int counter_read_page(struct txn *txn);
