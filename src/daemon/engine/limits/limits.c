/* SPDX-License-Identifier: MIT */
/* The limit alarms of a signal: what is known of the signal goes in, journal and state come out. */
#include <errno.h>
#include <string.h>

#include "hal/base/time.h"
#include "src/daemon/engine/limits/limit.h"
#include "src/daemon/engine/limits/limits.h"
#include "src/ground/signal/value.h"
#include "src/ground/text/log.h"
#include "src/memory/shm/entries.h"

/* --- The shelves of the image ----------------------------------------------------------------- */

/*
 * Each entry of the image's area of shelves is one signal with a shelved alarm. owsd alone writes
 * the image, so the entries there are what the engine knows of them.
 */

static unsigned free_shelf(const struct engine *e)
{
	unsigned i = 0;

	while (i < OWS_SHELVES && e->image->shelves[i].record)
		i++;
	return i;
}

/* Enter the signal, or enter it anew. 0, -ENOSPC: OWS_SHELVES others are shelved. */
static int put_on_shelf(struct engine *e, struct signal *s, const struct ows_shelf_entry *entry)
{
	unsigned shelf = s->limit.shelf ? s->limit.shelf - 1u : free_shelf(e);

	if (shelf == OWS_SHELVES)
		return -ENOSPC;
	image_shelf(e->image, shelf, entry);
	s->limit.shelf = (uint8_t)(shelf + 1);
	return 0;
}

void engine_shelves_resume(struct engine *e)
{
	const struct ows_shelf_entry none = {0};

	for (uint32_t row = 0; row < e->table.count; row++) {
		e->table.signals[row].limit.shelf = 0;
		e->table.signals[row].limit.alarm.shelved = false;
	}
	for (unsigned i = 0; i < OWS_SHELVES; i++) {
		uint32_t record = e->image->shelves[i].record;
		struct signal *s;

		if (!record)
			continue;
		s = record <= e->table.count ? &e->table.signals[record - 1] : NULL;
		if (!s || !s->item->limits.any || s->limit.shelf) {
			image_shelf(e->image, i, &none);
			continue;
		}
		s->limit.shelf = (uint8_t)(i + 1);
		limit_shelve(&s->limit.alarm);
	}
}

/* After so many requests to shelve at once, one a second. */
#define SHELVINGS OWS_SHELVES

static void journal_limit(struct engine *e, const struct signal *s, uint8_t kind,
                          enum ows_alarm_event event)
{
	struct ows_journal_entry entry = signal_entry(s, (enum ows_alarm_kind)kind, event,
	                                              e->time.now_ns);

	if (s->limit.values) {
		entry.after = s->limit.value[1];
		entry.flags |= OWS_JOURNAL_AFTER;
	}
	if (s->limit.values > 1) {
		entry.before = s->limit.value[0];
		entry.flags |= OWS_JOURNAL_BEFORE;
	}
	image_alarm(e->image, &entry);
	e->published = true;
}

/* What a person did to the alarm: no value belongs to it. */
static void journal_deed(struct engine *e, const struct signal *s, uint8_t kind,
                         enum ows_alarm_event event, const struct ows_who *who,
                         const char why[OWS_TEXT])
{
	struct ows_journal_entry entry = signal_entry(s, (enum ows_alarm_kind)kind, event,
	                                              e->time.now_ns);

	entry.who = *who;
	memcpy(entry.text, why, OWS_TEXT);
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

/* Log the return only of an alarm whose raise was logged. */
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
	s->attrs.shelved = s->limit.alarm.shelved;
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

/* Raise what stands now. */
static void unshelve(struct engine *e, struct signal *s, const struct ows_who *who,
                     const char why[OWS_TEXT])
{
	const struct ows_shelf_entry none = {0};
	uint8_t kind = s->limit.alarm.kind;

	image_shelf(e->image, s->limit.shelf - 1u, &none);
	s->limit.shelf = 0;
	journal_deed(e, s, kind, OWS_ALARM_UNSHELVED, who, why);
	log_notice(e->log, "%s: alarm: no longer shelved", s->item->name);
	kind = limit_unshelve(&s->limit.alarm);
	if (kind)
		limit_raised(e, s, kind);
}

/* Returns when the shelved alarm is over; INT64_MAX: it is not shelved. */
static int64_t shelved_until(struct engine *e, struct signal *s)
{
	static const char over[OWS_TEXT] = "its time is over";
	const struct ows_who owsd = {0};
	int64_t until_ns;

	if (!s->limit.shelf)
		return INT64_MAX;
	until_ns = e->image->shelves[s->limit.shelf - 1].until_ns;
	if (until_ns > e->time.now_ns)
		return until_ns;
	unshelve(e, s, &owsd, over);
	return INT64_MAX;
}

/* Bring the alarm to the present. Returns when this is to be done again. */
static int64_t evaluate_limits(struct engine *e, struct signal *s)
{
	int64_t stale_at = signal_stale_at(s), next;
	struct limit_reading reading;
	struct limit_news news;

	if (s->sample.quality == OWS_Q_DISABLED)
		return INT64_MAX;
	keep_limit_value(s);
	reading = (struct limit_reading){
		.value = value_number(s->item->type, s->sample.value),
		.bad = (s->sample.quality & 0xc0) == 0 && s->sample.quality != OWS_Q_INITIAL,
		.unknown = s->sample.quality == OWS_Q_INITIAL,
	};
	reading.stale = !reading.bad && e->time.now_ns >= stale_at;
	next = limit_evaluate(&s->limit.alarm, &s->item->limits, &reading, e->time.now_ns, &news);
	if (news.returned)
		limit_returned(e, s, news.returned);
	if (news.raised)
		limit_raised(e, s, news.raised);
	return reading.bad || reading.stale ? next : earlier_ns(next, stale_at);
}

int64_t engine_limits(struct engine *e, struct signal *s)
{
	int64_t next;

	if (!s->item->limits.any)
		return INT64_MAX;
	next = evaluate_limits(e, s);
	next = earlier_ns(next, shelved_until(e, s));
	show_limit(s);
	return next;
}

void engine_limits_end(struct engine *e, const struct signal *s, const struct signal *before)
{
	const struct limit *alarm = &before->limit.alarm;

	if (alarm->state == OWS_LIMIT_UNACKNOWLEDGED || alarm->state == OWS_LIMIT_ACKNOWLEDGED)
		journal_limit(e, s, alarm->kind, OWS_ALARM_RETURNED);
}

void engine_limits_acknowledge(struct engine *e, struct signal *s, const struct ows_who *who)
{
	static const char nothing[OWS_TEXT];
	uint8_t kind = limit_acknowledge(&s->limit.alarm);

	if (!kind)
		return;
	journal_deed(e, s, kind, OWS_ALARM_ACKNOWLEDGED, who, nothing);
	show_limit(s);
}

/* A program that shelves without end would push everything else out of journal and log. */
static bool may_shelve(struct engine *e)
{
	int64_t since_ns = e->time.now_ns - e->shelvings.since_ns;
	int64_t more = since_ns / NS_PER_S;

	if (more > e->shelvings.done) {
		e->shelvings.done = 0;
		e->shelvings.since_ns = e->time.now_ns;
	} else {
		e->shelvings.done -= (uint32_t)more;
		e->shelvings.since_ns += more * NS_PER_S;
	}
	return e->shelvings.done < SHELVINGS && ++e->shelvings.done;
}

int engine_shelve(struct engine *e, struct signal *s, uint32_t seconds, const struct ows_who *who,
                  const char *why)
{
	struct ows_shelf_entry entry = {
		.record = s->record,
		.since_ns = e->time.now_ns,
		.until_ns = e->time.now_ns + seconds * NS_PER_S,
		.who = *who,
	};
	int err;

	memcpy(entry.why, why, strnlen(why, OWS_TEXT - 1));
	if (!s->item->limits.any)
		return -EOPNOTSUPP;
	if (seconds > OWS_SHELVE_MAX)
		return -ERANGE;
	if (!seconds && !s->limit.shelf)
		return 0;
	if (!may_shelve(e))
		return -EAGAIN;
	if (!seconds) {
		unshelve(e, s, who, entry.why);
		return 0;
	}
	err = put_on_shelf(e, s, &entry);
	if (err)
		return err;
	journal_deed(e, s, s->limit.alarm.kind, OWS_ALARM_SHELVED, who, entry.why);
	log_notice(e->log, "%s: alarm: shelved for %u s by " LOG_PROGRAM ": \"%s\"", s->item->name,
	           seconds, who->name, (int)who->pid, (unsigned)who->uid, entry.why);
	s->limit.logged = false;
	limit_shelve(&s->limit.alarm);
	return 0;
}
