/* SPDX-License-Identifier: MIT */
/* Searches take 0 first: of two ids the one that has it where they part comes first. */
#include <stdbool.h>
#include <string.h>

#include "hal/serial/known.h"
#include "hal/wire/search.h"

static bool comes_before(const uint8_t a[8], const uint8_t b[8])
{
	unsigned same = search_common(a, b);

	return same < 64 && (b[same / 8] >> same % 8 & 1);
}

int known_expect(const struct known_ids *known, const uint8_t directions[8])
{
	int first = -1;

	for (unsigned i = 0; i < known->n; i++)
		if (!comes_before(known->id[i], directions) &&
		    (first < 0 || comes_before(known->id[i], known->id[first])))
			first = (int)i;
	return first;
}

void known_found(struct known_ids *known, int expected, const uint8_t id[8])
{
	if (expected >= 0 && memcmp(known->id[expected], id, 8) != 0)
		memmove(known->id[expected], known->id[--known->n], 8);
	for (unsigned i = 0; i < known->n; i++)
		if (memcmp(known->id[i], id, 8) == 0)
			return;
	if (known->n < KNOWN_IDS)
		memcpy(known->id[known->n++], id, 8);
}
