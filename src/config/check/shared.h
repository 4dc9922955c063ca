/* SPDX-License-Identifier: MIT */
/* Items that write the same register of a device. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

struct config;
struct config_report;

/* What a write of a property sets: a part of a register of a device. */
struct shared_bits {
	uint64_t where;      /* a hash of the device and of what holds the command */
	const char *element; /* "3", "A", "BYTE"; "": all of it; it points into the path */
};

/* False: the path names no property that a device may have. */
bool shared_bits(const char *path, struct shared_bits *bits);
/* Do both set the same bits, as PIO.0 and PIO.BYTE of one device? */
bool shared_overlap(const struct shared_bits *a, const struct shared_bits *b);

/*
 * Warn of two items, outputs or inputs with Writable, that set the same bits: owsd writes the last
 * command of either, and the other then differs from what it was commanded. Restore of one undoes
 * the commands of the other.
 * name: only pairs with that item; NULL: all.
 */
void shared_check(const struct config *config, const char *name, struct config_report *report);
