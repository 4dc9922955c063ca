/* SPDX-License-Identifier: MIT */
/* The limit alarms of a signal: what is known of the signal goes in, journal and state come out. */
#include "src/engine/limits.h"
#include "src/engine/due.h"
#include "src/engine/limit.h"
#include "src/engine/state.h"
#include "src/signal/value.h"
#include "src/text/log.h"

static void journal_limit(struct engine *e, const struct signal *s, uint8_t kind, uint8_t event)
{
	struct ows_alarm_entry entry = {
		.record = s->record,
		.occurred_ns = e->time.now_ns,
		.kind = kind,
		.event = event,
		.quality = s->sample.quality,
	};

	if (event != OWS_ALARM_ACKNOWLEDGED && s->limit.values) {
		entry.after = s->limit.value[1];
		entry.flags |= OWS_ALARM_AFTER;
	}
	if (event != OWS_ALARM_ACKNOWLEDGED && s->limit.values > 1) {
		entry.before = s->limit.value[0];
		entry.flags |= OWS_ALARM_BEFORE;
	}
	image_alarm(e->image, &entry);
	e->published = true;
}

static void limit_raised(struct engine *e, struct signal *s, uint8_t kind)
{
	uint64_t n = log_rate(&s->limit.log, e->time.now_ns);
	char others[LOG_OTHERS];

	journal_limit(e, s, kind, OWS_ALARM_RAISED);
	s->limit.logged |= n != 0;
	if (n)
		log_warning(e->log, "%s: alarm: %s%s", s->item->name, ows_alarm_kind_text(kind),
		            log_others(n, others));
}

/* Where the log has the one it has the other: it does not end with an alarm that is over. */
static void limit_returned(struct engine *e, struct signal *s, uint8_t kind)
{
	journal_limit(e, s, kind, OWS_ALARM_RETURNED);
	if (s->limit.logged)
		log_notice(e->log, "%s: alarm: %s: returned to normal", s->item->name,
		           ows_alarm_kind_text(kind));
	s->limit.logged = false;
}

static void show_limit(struct signal *s)
{
	s->attrs.limit_state = (uint8_t)s->limit.alarm.state;
	s->attrs.limit_condition = s->limit.alarm.kind;
}

static void keep_limit_value(struct signal *s)
{
	if (s->sample.count == s->limit.count)
		return;
	s->limit.count = s->sample.count;
	if (s->limit.values < 2)
		s->limit.values++;
	s->limit.value[0] = s->limit.value[1];
	s->limit.value[1] = s->sample.value;
}

void engine_limits(struct engine *e, struct signal *s)
{
	const struct config_limits *limits = &s->item->limits;
	int64_t stale_at = INT64_MAX, next;
	struct limit_reading reading;
	struct limit_news news;

	if (!limits->any)
		return;
	if (s->sample.quality == OWS_Q_DISABLED) {
		due_wheel_cancel(&e->limit_wheel, engine_row(s));
		return;
	}
	keep_limit_value(s);
	if (s->item->stale_after_ns)
		stale_at = s->item->stale_after_ns + 1 +
		           (s->sample.measured_ns ? s->sample.measured_ns : s->read.known_ns);
	reading = (struct limit_reading){
		.value = value_number(s->item->type, s->sample.value),
		.bad = (s->sample.quality & 0xc0) == 0 && s->sample.quality != OWS_Q_INITIAL,
		.unknown = s->sample.quality == OWS_Q_INITIAL,
	};
	reading.stale = !reading.bad && e->time.now_ns >= stale_at;
	next = limit_evaluate(&s->limit.alarm, limits, &reading, e->time.now_ns, &news);
	if (news.returned)
		limit_returned(e, s, news.returned);
	if (news.raised)
		limit_raised(e, s, news.raised);
	show_limit(s);
	if (!reading.bad && !reading.stale && stale_at < next)
		next = stale_at;
	if (next == INT64_MAX)
		due_wheel_cancel(&e->limit_wheel, engine_row(s));
	else
		due_wheel_at(&e->limit_wheel, engine_row(s), engine_period_at(e, next));
}

void engine_limits_acknowledge(struct engine *e, struct signal *s)
{
	uint8_t kind = limit_acknowledge(&s->limit.alarm);

	if (!kind)
		return;
	journal_limit(e, s, kind, OWS_ALARM_ACKNOWLEDGED);
	show_limit(s);
}
