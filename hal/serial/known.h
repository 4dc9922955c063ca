/* SPDX-License-Identifier: MIT */
/* The ids that the searches of a wire have found: to which of them the next one leads. */
#pragma once

#include <stdint.h>

#define KNOWN_IDS 64

struct known_ids {
	uint8_t id[KNOWN_IDS][8];
	unsigned n;
};

/* That to which a search with these directions leads, unless something has changed; -1: to none. */
int known_expect(const struct known_ids *known, const uint8_t directions[8]);
/* A search has found id where that one was expected, which is forgotten if it is another. */
void known_found(struct known_ids *known, int expected, const uint8_t id[8]);
