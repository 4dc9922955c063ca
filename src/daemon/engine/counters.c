/* SPDX-License-Identifier: MIT */
/* The counters of the engine and of its lanes: their names, their values, and the image of them. */
#include <string.h>

#include "src/daemon/engine/counters.h"
#include "src/daemon/engine/state.h"

static const char *const engine_names[] = {
#define X(name) #name,
	ENGINE_COUNTERS(X)
#undef X
};
static const char *const lane_names[] = {
#define X(name) #name,
	LANE_COUNTERS(X)
#undef X
};
#define ENGINE_NAMES (sizeof(engine_names) / sizeof(engine_names[0]))
#define LANE_NAMES (sizeof(lane_names) / sizeof(lane_names[0]))

unsigned engine_counter_count(unsigned port_count)
{
	return (unsigned)(ENGINE_NAMES + port_count * LANE_NAMES);
}

void engine_counter_plan(unsigned port_count, struct image_counter *counters)
{
	for (unsigned i = 0; i < ENGINE_NAMES; i++)
		*counters++ = (struct image_counter){engine_names[i], UINT32_MAX};
	for (unsigned port = 0; port < port_count; port++)
		for (unsigned i = 0; i < LANE_NAMES; i++)
			*counters++ = (struct image_counter){lane_names[i], port};
}

uint64_t engine_counter(const struct engine *e, unsigned index)
{
	uint64_t total;
	const char *from;

	if (index < ENGINE_NAMES) {
		from = (const char *)&e->counters + index * sizeof(total);
	} else {
		index -= (unsigned)ENGINE_NAMES;
		from = (const char *)&e->lanes[index / LANE_NAMES].counters +
		       index % LANE_NAMES * sizeof(total);
	}
	memcpy(&total, from, sizeof(total));
	return total;
}

void engine_publish_counters(struct engine *e)
{
	unsigned count = engine_counter_count(e->lane_count);

	for (unsigned i = 0; i < count; i++)
		image_counter(e->image, i, engine_counter(e, i));
}
