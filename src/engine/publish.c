/* SPDX-License-Identifier: MIT */
/* What the image shows of a signal and of the driver. */
#include "private.h"

#include <string.h>

void engine_publish(struct engine *e, struct signal *s)
{
	struct ows_sample sample;

	engine_limits(e, s);
	s->sample.flags = (s->commanded && signal_writes(s) && signal_changed(s)
	                           ? OWS_SAMPLE_PENDING
	                           : 0) |
	                  (s->safe ? OWS_SAMPLE_SAFE : 0);
	s->attrs.commanded = s->command;
	if (s->commanded)
		s->attrs.flags |= OWS_ATTR_COMMANDED;
	sample = s->sample;
	if (!sample.err)
		sample.err = s->write_err;
	if (!sample.err && !signal_writes(s)) /* else it would be said of a write */
		sample.err = s->alarm_err;
	image_publish(e->image, s->record, &sample, &s->attrs, s->text);
	e->published = true;
}

void engine_publish_driver(struct engine *e, int64_t now_ns)
{
	struct ows_sample sample = {
		.value = (int64_t)e->reconnects,
		.measured_ns = now_ns,
		.tried_ns = now_ns,
		.quality = OWS_Q_GOOD,
		.target = 255,
		.count = (uint32_t)e->period,
	};
	struct ows_attrs attrs = {
		.transactions = e->transactions,
		.per_base = (uint32_t)e->period,
	};

	image_publish(e->image, 0, &sample, &attrs, NULL);
	e->published = true;
}

void engine_publish_target(struct engine *e, const struct lane *lane)
{
	uint32_t state = lane->up ? 1 : engine_way(e, lane)->released ? 2 : 0;

	image_target(e->image, lane->index, state, (uint32_t)lane->counters.reconnects);
	image_moves(e->image, lane->index, (uint32_t)lane->counters.moves_in);
	e->published = true;
}

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
#define LANE_NAMES   (sizeof(lane_names) / sizeof(lane_names[0]))

unsigned engine_counter_count(unsigned port_count)
{
	return (unsigned)(ENGINE_NAMES + port_count * LANE_NAMES);
}

void engine_counter_plan(unsigned port_count, struct image_counter *counters)
{
	for (unsigned i = 0; i < ENGINE_NAMES; i++)
		*counters++ = (struct image_counter){ engine_names[i], UINT32_MAX };
	for (unsigned port = 0; port < port_count; port++)
		for (unsigned i = 0; i < LANE_NAMES; i++)
			*counters++ = (struct image_counter){ lane_names[i], port };
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
