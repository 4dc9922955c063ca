/* SPDX-License-Identifier: MIT */
/* The states that the search has been in. */
#include <stdlib.h>

#include "tests/model/search.h"

static uint64_t *seen, room; /* a power of 2 */

static uint64_t hash_all(void)
{
	uint64_t h = weak_hash(&x.memory);

	for (unsigned i = 0; i < x.scenario->threads; i++) {
		const struct thread *t = &x.threads[i];

		h = mix(mix(h, t->history), (uint64_t)t->state * 2 + t->killed);
		if (t->state != DONE) {
			h = mix(h, (uint64_t)t->step.kind << 32 | t->step.location);
			h = mix(mix(h, t->step.value), (uintptr_t)t->step.site);
		}
	}
	for (unsigned i = 0; i < x.kept_count; i++) {
		const unsigned char *bytes = x.kept[i].at;

		for (size_t j = 0; j < x.kept[i].size; j++)
			h = mix(h, bytes[j]);
	}
	return h != 0 ? h : 1;
}

static void put_seen(uint64_t *table, uint64_t size, uint64_t h)
{
	uint64_t i = h & (size - 1);

	while (table[i] != 0)
		i = (i + 1) & (size - 1);
	table[i] = h;
}

static void grow(void)
{
	uint64_t more = room * 2, *table = calloc(more, sizeof(*table));

	if (!table)
		abort();
	for (uint64_t i = 0; i < room; i++)
		if (seen[i] != 0)
			put_seen(table, more, seen[i]);
	free(seen);
	seen = table;
	room = more;
}

void seen_begin(void)
{
	room = 1 << 12;
	seen = calloc(room, sizeof(*seen));
	if (!seen)
		abort();
}

bool seen_before(void)
{
	uint64_t h = hash_all();

	for (uint64_t i = h & (room - 1); seen[i] != 0; i = (i + 1) & (room - 1))
		if (seen[i] == h)
			return true;
	if (x.result->states * 2 > room)
		grow();
	put_seen(seen, room, h);
	return false;
}

void seen_end(void)
{
	free(seen);
}
