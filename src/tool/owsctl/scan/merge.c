/* SPDX-License-Identifier: MIT */
/*
 * Decides which devices of a configuration stay, are missing or are replaced, and which of those
 * found are new.
 */
#include <string.h>

#include "src/tool/owsctl/scan/merge.h"

static int merge_find(const struct merge_device *list, unsigned count, const uint8_t rom[ROM_LEN])
{
	for (unsigned i = 0; i < count; i++)
		if (memcmp(list[i].rom, rom, ROM_LEN) == 0)
			return (int)i;
	return -1;
}

static const char *merge_replace(struct merge_device *known, unsigned known_count,
                                 struct merge_device *found, unsigned found_count,
                                 const struct merge_pair *pair)
{
	int old = merge_find(known, known_count, pair->old_rom);
	int new = merge_find(found, found_count, pair->new_rom);

	if (old < 0)
		return "no item of the file has this device";
	if (known[old].fate == MERGE_STAYS)
		return "the old device is still there";
	if (new < 0)
		return "the new device was not found";
	if (found[new].fate == MERGE_STAYS)
		return "the new device has items in the file already";
	if (known[old].rom[0] != found[new].rom[0])
		return "they are of different families, which have different properties";
	if (known[old].fate == MERGE_REPLACED || found[new].fate == MERGE_REPLACED)
		return "one of the two is in another --replace too";
	known[old].fate = found[new].fate = MERGE_REPLACED;
	known[old].other = new;
	found[new].other = old;
	return NULL;
}

static unsigned merge_count(const struct merge_device *list, unsigned n, uint8_t family,
                            enum merge_fate fate)
{
	unsigned sum = 0;

	for (unsigned i = 0; i < n; i++)
		sum += list[i].rom[0] == family && list[i].fate == fate;
	return sum;
}

/* Note where as many devices of a family are new as are missing: they may be replacements. */
static void pair_up(struct merge_device *known, unsigned known_count, struct merge_device *found,
                    unsigned found_count)
{
	for (unsigned i = 0; i < known_count; i++) {
		uint8_t family = known[i].rom[0];
		unsigned missing = merge_count(known, known_count, family, MERGE_MISSING);

		if (known[i].fate != MERGE_MISSING ||
		    missing != merge_count(found, found_count, family, MERGE_NEW))
			continue;
		known[i].pairs = missing;
		for (unsigned k = 0; k < found_count; k++)
			if (found[k].rom[0] == family && found[k].fate == MERGE_NEW)
				found[k].pairs = missing;
	}
}

const char *merge_decide(struct merge_device *known, unsigned known_count,
                         struct merge_device *found, unsigned found_count,
                         const struct merge_pair *pairs, unsigned pair_count, unsigned *wrong)
{
	for (unsigned i = 0; i < known_count; i++) {
		bool there = merge_find(found, found_count, known[i].rom) >= 0;

		known[i].fate = there ? MERGE_STAYS : MERGE_MISSING;
		known[i].other = -1;
		known[i].pairs = 0;
	}
	for (unsigned i = 0; i < found_count; i++) {
		bool there = merge_find(known, known_count, found[i].rom) >= 0;

		found[i].fate = there ? MERGE_STAYS : MERGE_NEW;
		found[i].other = -1;
		found[i].pairs = 0;
	}
	for (*wrong = 0; *wrong < pair_count; ++*wrong) {
		const char *fault = merge_replace(known, known_count, found, found_count,
		                                  &pairs[*wrong]);

		if (fault)
			return fault;
	}
	pair_up(known, known_count, found, found_count);
	return NULL;
}
