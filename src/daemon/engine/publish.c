/* SPDX-License-Identifier: MIT */
/* What the image shows of a signal, of a target and of owsd itself. */
#include "src/daemon/engine/publish.h"

#include <math.h>
#include <string.h>

#include "src/daemon/engine/due.h"
#include "src/daemon/engine/limits/limits.h"
#include "src/ground/signal/value.h"
#include "src/memory/shm/entries.h"

/* The attributes that say how a signal stands; the others count, or are of one moment. */
#define STANDING (~(uint32_t)OWS_ATTR_IN_WORK)

/* Nearer than Deadband to what was entered last? A text is not measured. */
static bool is_near(const struct signal *s, int64_t value)
{
	double was = value_number(s->item->type, s->entered.value);

	return s->item->deadband > 0 && !signal_is_string(s) &&
	       fabs(value_number(s->item->type, value) - was) < s->item->deadband;
}

/*
 * Enter a change if the row differs for a program that follows it: an update, even of the same
 * value (it is a new sample, and the age is new), or how it stands.
 */
static void enter_change(struct engine *e, struct signal *s, const struct ows_sample *sample,
                         bool stale)
{
	struct signal_entered *was = &s->entered;
	struct signal_entered now = {
		.value = was->value,
		.commanded = s->attrs.commanded,
		.count = was->count,
		.alarms = s->attrs.alarms,
		.flags = s->attrs.flags & STANDING,
		.err = sample->err,
		.quality = sample->quality,
		.detail = sample->detail,
		.target = sample->target,
		.sample_flags = sample->flags,
		.limit_state = s->attrs.limit_state,
		.limit_condition = s->attrs.limit_condition,
		.shelved = s->attrs.shelved,
		.stale = stale,
	};
	bool stands = memcmp(&now, was, sizeof(now)) == 0;

	if (stands && (sample->count == was->count || is_near(s, sample->value))) {
		was->count = sample->count;
		return;
	}
	*was = now;
	was->value = sample->value;
	was->count = sample->count;
	image_change(e->image, s->record);
}

/* Look again when the row changes by time alone. A look too soon does no harm. */
static void look_again(struct engine *e, const struct signal *s, int64_t when_ns)
{
	const struct due_wait *wait = &e->wheel.wait[engine_row_wait(s, WAIT_TIME)];
	uint64_t period;

	if (when_ns == INT64_MAX) {
		due_wheel_cancel(&e->wheel, engine_row_wait(s, WAIT_TIME));
		return;
	}
	period = engine_period_at(e, when_ns);
	if (!wait->waits || wait->period > period)
		due_wheel_at(&e->wheel, engine_row_wait(s, WAIT_TIME), period);
}

void engine_publish(struct engine *e, struct signal *s)
{
	int64_t next = engine_limits(e, s), stale_at = signal_stale_at(s);
	struct ows_sample sample;
	bool stale;

	s->sample.flags = (s->command.given && signal_writes(s) && signal_changed(s)
	                           ? OWS_SAMPLE_PENDING
	                           : 0) |
	                  (s->command.reason == OWS_REASON_SAFE ? OWS_SAMPLE_SAFE : 0);
	s->attrs.commanded = s->command.value;
	if (s->command.given)
		s->attrs.flags |= OWS_ATTR_COMMANDED;
	else
		s->attrs.flags &= ~(uint32_t)OWS_ATTR_COMMANDED;
	sample = s->sample;
	if (!sample.err)
		sample.err = s->command.err;
	if (!sample.err && s->command.storing)
		sample.err = e->store_err;
	if (!sample.err && !signal_writes(s)) /* else it would look like the error of a write */
		sample.err = s->alarm_err;
	stale = ows_good(sample.quality) && e->time.now_ns >= stale_at;
	if (ows_good(sample.quality) && !stale)
		next = earlier_ns(next, stale_at);
	look_again(e, s, next);
	image_publish(e->image, s->record, &sample, &s->attrs, s->text);
	enter_change(e, s, &sample, stale);
	e->published = true;
}

bool engine_driver_changed(const struct engine *e)
{
	return e->driver.transactions + e->driver.reconnects != e->driver.shown;
}

void engine_publish_driver(struct engine *e)
{
	struct ows_sample sample = {
		.value = (int64_t)e->driver.reconnects,
		.measured_ns = e->time.now_ns,
		.tried_ns = e->time.now_ns,
		.quality = OWS_Q_GOOD,
		.target = 255,
		.count = (uint32_t)e->time.period,
	};
	struct ows_attrs attrs = {
		.transactions = e->driver.transactions,
		.per_base = (uint32_t)e->time.period,
	};

	image_publish(e->image, 0, &sample, &attrs, NULL);
	/* the heartbeat alone wakes no reader */
	if (engine_driver_changed(e))
		e->published = true;
	e->driver.shown = e->driver.transactions + e->driver.reconnects;
}

void engine_publish_target(struct engine *e, const struct lane *lane)
{
	bool up = lane->state.up && !lane->state.stuck; /* what hangs cannot report that */
	uint32_t state = up ? 1 : engine_way(e, lane)->released ? 2 : 0;
	const struct lane_note *note = up ? &lane->state.trouble : &lane->state.why_down;

	image_target(e->image, lane->index, state, (uint32_t)lane->counters.reconnects);
	image_moves(e->image, lane->index, (uint32_t)lane->counters.moves_in);
	image_note(e->image, lane->index, note->since_ns, note->text);
	e->published = true;
}
