/* SPDX-License-Identifier: MIT */
/* Finds the shelved limit alarm of a record in the image. */
#include <string.h>

#include "src/libows/by.h"
#include "src/libows/handle.h"
#include "src/libows/shelved.h"
#include "src/shm/reader.h"

void shelved_of(struct ows *h, uint32_t record, struct ows_alarm_state *state)
{
	uint32_t count = map_count(&h->map, OWS_AREA_SHELVES);
	struct ows_shelf_entry e;

	for (uint32_t i = 0; i < count; i++) {
		if (!reader_entry(map_entry(&h->map, OWS_AREA_SHELVES, i), &e, sizeof(e)) ||
		    e.record != record)
			continue;
		state->since_ns = e.since_ns;
		state->until_ns = e.until_ns;
		state->who = by_of(&e.who);
		memcpy(state->why, e.why, sizeof(state->why) - 1);
		return;
	}
}
