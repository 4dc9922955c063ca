/* SPDX-License-Identifier: MIT */
/*
 * The ROM search (Maxim application note 187), one device per call, so that other work fits
 * between. Made of run() and triplet() of a link, or of slot() where it has no triplet.
 */
#pragma once

#include "hal/wire/link.h"

#define ONEWIRE_SEARCH 0xf0
#define ONEWIRE_ALARM_SEARCH 0xec

/*
 * When only one known device is left below the first bits of prefix: put its id into rom and
 * return true, and the rest of the slots is saved.
 */
typedef bool search_lone(void *ctx, const uint8_t prefix[8], unsigned bits, uint8_t rom[8]);

struct search {
	uint8_t rom[8];    /* the device found last */
	uint8_t command;   /* ONEWIRE_SEARCH or ONEWIRE_ALARM_SEARCH */
	uint8_t family;    /* 0: all; else the search ends behind this family */
	uint8_t branch;    /* deepest untried branch of the last call, 1 to 64; 0: none */
	bool last;         /* nothing left */
	search_lone *lone; /* may be NULL */
	void *ctx;
};

/* As link_ops.path, also where the link has none. */
int search_path(struct link *link, bool reset, uint8_t command, uint8_t rom[8],
                uint8_t conflict[8]);
/* Are the first bits of two ids the same? */
bool search_same(const uint8_t a[8], const uint8_t b[8], unsigned bits);
/* How many of their first bits are the same: up to 64. */
unsigned search_common(const uint8_t a[8], const uint8_t b[8]);
void search_begin(struct search *search, bool alarm, uint8_t family);
/*
 * 1 and the device in search->rom; 0 when there is no further one; -EBADMSG the id's checksum is
 * wrong or devices left in the middle (the next call tries the same again); or the link's error.
 */
int search_next(struct search *search, struct link *link);
/*
 * Is rom there? 1, 0 or an error. With alarm: is it in alarm. Leaves the device selected, which
 * is how a DS2405 is read.
 */
int search_verify(struct link *link, const uint8_t rom[8], bool alarm);
/*
 * The same of the first bits of roms[0], of n, all 64 or less; away[i] becomes true for each that
 * this one search shows not to be there, roms[0] included: ids that no chip is near to are decided
 * together. What is true already stays. It leaves nothing selected.
 */
int search_among(struct link *link, const uint8_t *const roms[], bool away[], unsigned n,
                 unsigned bits);
