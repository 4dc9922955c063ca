/* SPDX-License-Identifier: MIT */
/* What the image shows of a signal, of a target and of owsd itself. */
#include "src/engine/publish.h"
#include "src/engine/limits.h"
#include "src/engine/state.h"

void engine_publish(struct engine *e, struct signal *s)
{
	struct ows_sample sample;

	engine_limits(e, s);
	s->sample.flags = (s->command.given && signal_writes(s) && signal_changed(s)
	                           ? OWS_SAMPLE_PENDING
	                           : 0) |
	                  (s->command.safe ? OWS_SAMPLE_SAFE : 0);
	s->attrs.commanded = s->command.value;
	if (s->command.given)
		s->attrs.flags |= OWS_ATTR_COMMANDED;
	sample = s->sample;
	if (!sample.err)
		sample.err = s->command.err;
	if (!sample.err && !signal_writes(s)) /* else it would look like the error of a write */
		sample.err = s->alarm_err;
	image_publish(e->image, s->record, &sample, &s->attrs, s->text);
	e->published = true;
}

void engine_publish_driver(struct engine *e, int64_t now_ns)
{
	struct ows_sample sample = {
		.value = (int64_t)e->driver.reconnects,
		.measured_ns = now_ns,
		.tried_ns = now_ns,
		.quality = OWS_Q_GOOD,
		.target = 255,
		.count = (uint32_t)e->time.period,
	};
	struct ows_attrs attrs = {
		.transactions = e->driver.transactions,
		.per_base = (uint32_t)e->time.period,
	};

	image_publish(e->image, 0, &sample, &attrs, NULL);
	e->published = true;
}

void engine_publish_target(struct engine *e, const struct lane *lane)
{
	uint32_t state = lane->state.up ? 1 : engine_way(e, lane)->released ? 2 : 0;

	image_target(e->image, lane->index, state, (uint32_t)lane->counters.reconnects);
	image_moves(e->image, lane->index, (uint32_t)lane->counters.moves_in);
	e->published = true;
}
