/* SPDX-License-Identifier: MIT */
/* The EPROM of DS2505 and DS2506: pages of 32 bytes, and status bytes in eleven pages. */
#pragma once

#include "hal/chips/area.h"

/* The loads of these areas. */
int eprom_load(struct txn *txn, const struct area *area, unsigned at, uint8_t *bytes, unsigned n);
int eprom_load_status(struct txn *txn, const struct area *area, unsigned at, uint8_t *bytes,
                      unsigned n);

/* One bit for each page of the memory in each of three status pages, and one byte in eight. */
#define EPROM_STATUS_PAGES 11
#define EPROM_MEMORY(pages) .name = "memory", .size = 32 * (pages), .block = 32, .load = eprom_load
#define EPROM_STATUS(pages) \
	.name = "status", .size = EPROM_STATUS_PAGES * (pages) / 8, .block = 8, \
	.load = eprom_load_status
