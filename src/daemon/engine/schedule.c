/* SPDX-License-Identifier: MIT */
/* When the rows of the table are read and written: the wheel of periods and what is due. */
#include "src/daemon/engine/schedule.h"
#include "hal/base/time.h"
#include "src/daemon/engine/alarm/alarm_item.h"
#include "src/daemon/engine/command/origin.h"
#include "src/daemon/engine/due.h"
#include "src/daemon/engine/publish.h"
#include "src/daemon/engine/retry.h"

/* So long counts a reading that somebody asked for, of what is not read else. */
#define ONCE_GOOD_NS (10 * NS_PER_S)

void engine_read_now(struct engine *e, struct signal *s)
{
	if (s->reading || !signal_is_read(s))
		return;
	due_wheel_cancel(&e->wheel, engine_row_wait(s, WAIT_READ));
	due_set_add(&engine_lane(e, s)->inputs, engine_row(s));
}

void engine_read_at(struct engine *e, struct signal *s, uint64_t period)
{
	if (!signal_reads(s) && !s->item->read_back_ns && !s->read.once && !signal_lapses(s))
		return;
	if (period <= e->time.period) {
		engine_read_now(e, s);
		return;
	}
	due_set_remove(&engine_lane(e, s)->inputs, engine_row(s));
	due_wheel_at(&e->wheel, engine_row_wait(s, WAIT_READ), period);
}

void engine_read_once(struct engine *e, struct signal *s)
{
	s->read.once = true;
	if (!s->reading)
		engine_read_at(e, s,
		               e->time.period + (s->attrs.pend_base == (uint32_t)e->time.period));
}

void engine_read_never(struct engine *e, struct signal *s)
{
	due_wheel_cancel(&e->wheel, engine_row_wait(s, WAIT_READ));
	due_set_remove(&engine_lane(e, s)->inputs, engine_row(s));
}

/* An alarm item is read when it has something to say, and now and then to see that it lives. */
uint64_t engine_reads_apart(const struct engine *e, const struct lane *lane, const struct signal *s)
{
	if (s->item->alarm && alarm_serves(&lane->alarm) && s->item->per_factor == 1 &&
	    !(s->attrs.flags & OWS_ATTR_ALARM_UNARMED))
		return engine_periods(e, CONFIG_ALARM_READ_NS);
	return s->item->per_factor;
}

void engine_write_at(struct engine *e, struct signal *s, uint64_t period)
{
	due_set_remove(&engine_lane(e, s)->outputs, engine_row(s));
	due_wheel_at(&e->wheel, engine_row_wait(s, WAIT_WRITE), period);
}

void engine_write_check(struct engine *e, struct signal *s)
{
	struct due_set *outputs = &engine_lane(e, s)->outputs;
	uint32_t row = engine_row(s);

	if (!signal_changed(s)) {
		due_wheel_cancel(&e->wheel, engine_row_wait(s, WAIT_WRITE));
		due_set_remove(outputs, row);
		retry_clear(&s->command.retry);
	} else if (s->doubts) {
		due_set_remove(outputs, row);
	} else if (!s->writing && !e->wheel.wait[engine_row_wait(s, WAIT_WRITE)].waits) {
		due_set_add(outputs, row);
	}
}

uint64_t engine_read_back_at(const struct engine *e, const struct signal *s)
{
	int64_t wait_ns = signal_lapses(s) ? ONCE_GOOD_NS : s->item->read_back_ns;
	int64_t restore_ns = s->restore.not_before_ns;

	if (s->command.differs && s->item->restores && restore_ns - e->time.now_ns < wait_ns)
		wait_ns = restore_ns - e->time.now_ns;
	return e->time.period + (wait_ns > 0 ? engine_periods(e, wait_ns) : 1);
}

/* A reading that somebody asked for, and its time is over. */
static void disable(struct engine *e, struct signal *s)
{
	s->sample.quality = OWS_Q_DISABLED;
	engine_publish(e, s);
}

void engine_row_due(struct engine *e, struct signal *s, enum row_wait wait)
{
	if (wait == WAIT_TIME)
		engine_publish(e, s);
	else if (wait == WAIT_JOURNAL)
		engine_origin_rest(e, s);
	else if (wait == WAIT_WRITE)
		engine_write_check(e, s);
	else if (signal_is_read(s))
		engine_read_now(e, s);
	else if (!signal_lapses(s))
		engine_read_at(e, s, engine_read_back_at(e, s));
	else
		disable(e, s);
}

/* A call so late says that the engine did not run: the machine was suspended, or owsd stopped. */
#define GAP_NS (2 * NS_PER_S)
/* A call so late says that the engine did not look, and that perhaps no controller could beat. */
#define PAUSE_NS (100 * NS_PER_MS)

/* The period that has begun last at that time. */
static uint64_t begun_period(const struct engine *e, int64_t ns)
{
	int64_t since_ns = ns - e->time.start_ns;

	return e->time.first + (since_ns > 0 ? (uint64_t)(since_ns / e->config->period_ns) : 0);
}

void engine_begin_call(struct engine *e, int64_t now_ns)
{
	uint64_t period;
	int64_t late_ns = now_ns -
	                  (e->time.next_ns > e->time.now_ns ? e->time.next_ns : e->time.now_ns);

	if (e->time.next_ns && now_ns - e->time.next_ns > GAP_NS)
		e->time.gap_ns = now_ns;
	/* when in the time since the last call the pause began is not known */
	if (e->time.next_ns && late_ns > PAUSE_NS) {
		e->time.paused_ns += now_ns - e->time.now_ns;
		e->time.resumed_ns = now_ns;
	}
	e->time.now_ns = now_ns;
	/* the last step may be periods ago */
	period = begun_period(e, now_ns);
	if (period > e->time.period)
		e->time.period = period;
}

bool engine_tick(struct engine *e, due_ready *ready)
{
	uint64_t period = e->time.period, asked = begun_period(e, e->time.next_ns);

	if (period == e->time.ticked)
		return false;
	if (asked <= e->time.ticked)
		asked = e->time.ticked + 1;
	if (period > asked)
		e->counters.late_periods += period - asked;
	e->counters.periods += period - e->time.ticked;
	e->time.ticked = period;
	due_wheel_advance(&e->wheel, period, ready, e);
	return true;
}

int64_t engine_next_tick(const struct engine *e, int64_t at_most_ns)
{
	uint64_t period = e->time.period, most = (uint64_t)(at_most_ns / e->config->period_ns);
	uint64_t next = period + (most ? most : 1);

	next = due_wheel_next(&e->wheel, period, next);
	return e->time.start_ns + (int64_t)(next - e->time.first) * e->config->period_ns;
}
