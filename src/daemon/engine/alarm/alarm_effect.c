/* SPDX-License-Identifier: MIT */
/*
 * What alarms and restarts of devices change in the table, in the journal and in the log. Where a
 * request of the machine fails, all three name the key and the property, and the item waits as a
 * signal that cannot be read does.
 */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "src/daemon/engine/alarm/alarm_effect.h"
#include "src/daemon/engine/alarm/alarm_text.h"
#include "src/daemon/engine/publish.h"
#include "src/daemon/engine/retry.h"
#include "src/daemon/engine/schedule.h"
#include "src/ground/signal/error.h"
#include "src/ground/signal/unarmed.h"
#include "src/ground/text/log.h"
#include "src/memory/shm/entries.h"

struct signal *alarm_signal(struct engine *e, const struct alarm_item *item)
{
	return &e->table.signals[item->row];
}

struct alarm_item *alarm_current(struct alarm_machine *m)
{
	return m->position < 0 ? NULL : m->items[m->position];
}

static struct ows_journal_entry alarm_entry(const struct engine *e, const struct signal *s,
                                            enum ows_alarm_kind kind, enum ows_alarm_event event)
{
	struct ows_journal_entry entry = signal_entry(s, kind, event, e->time.now_ns);

	if (s->sample.count && !signal_is_string(s)) {
		entry.before = s->sample.value;
		entry.flags = OWS_JOURNAL_BEFORE;
	}
	return entry;
}

void engine_alarm_raised(struct engine *e, struct lane *lane, struct alarm_item *item)
{
	struct signal *s = &e->table.signals[item->row];
	uint32_t channels = alarm_channels(item->occurrence.latch_text);
	struct ows_journal_entry entry;

	if (item->occurrence.stands && !(channels & ~item->occurrence.entered))
		return;
	item->occurrence.stands = true;
	s->attrs.alarms++;
	s->attrs.flags |= OWS_ATTR_ALARM_STANDS;
	lane->counters.alarms++;
	if (channels & ~item->occurrence.entered) {
		entry = alarm_entry(e, s, OWS_ALARM_DEVICE, OWS_ALARM_RAISED);
		memcpy(entry.text, item->occurrence.latch_text,
		       strnlen(item->occurrence.latch_text, sizeof(item->occurrence.latch_text)));
		item->occurrence.journal = image_alarm(e->image, &entry);
		item->occurrence.entered |= channels;
		item->occurrence.wants_after = true;
		log_notice(e->log, "%s: alarm, %s is %s", s->item->name, item->strings.latch,
		           item->occurrence.latch_text);
	}
	engine_publish(e, s);
}

void engine_alarm_rests(struct engine *e, struct alarm_item *item)
{
	struct signal *s = &e->table.signals[item->row];
	struct ows_journal_entry entry = alarm_entry(e, s, OWS_ALARM_DEVICE, OWS_ALARM_RETURNED);

	item->occurrence.stands = false;
	if (s->attrs.flags & OWS_ATTR_ALARM_STANDS) {
		s->attrs.flags &= ~(uint32_t)OWS_ATTR_ALARM_STANDS;
		engine_publish(e, s);
	}
	if (!item->occurrence.entered)
		return;
	item->occurrence.entered = 0;
	image_alarm(e->image, &entry);
	e->published = true;
}

void engine_power_on_reset(struct lane *lane, const struct device *d, const struct signal *shown,
                           bool seen)
{
	struct engine *e = lane->engine;
	struct ows_journal_entry entry = alarm_entry(e, shown, OWS_ALARM_POR, OWS_ALARM_RAISED);

	image_alarm(e->image, &entry);
	e->published = true;
	lane->counters.power_on_resets++;
	/* each board of a plant that is switched on has, and so it is no news at the start */
	log_at(e->log, seen ? LOG_LEVEL_NOTICE : LOG_LEVEL_INFO,
	       "%s (%s): the device has restarted%s", shown->item->name, shown->item->path,
	       seen ? "" : " before owsd looked at it first");
	for (uint32_t k = 0; k < d->count; k++) {
		struct signal *s = d->signals[k];

		/* after a restart before owsd's first look it got its command, and no InitValue */
		if (!seen && s->command.confirmed && signal_repeats(s))
			s->command.forced = true;
		else
			signal_forget_written(s);
		engine_write_check(e, s);
	}
}

void engine_alarm_polled(struct engine *e, struct alarm_item *item)
{
	engine_alarm_rests(e, item);
	alarm_signal(e, item)->attrs.flags |= OWS_ATTR_ALARM_POLLED;
}

void engine_alarm_polls(struct engine *e, struct alarm_machine *m)
{
	for (uint32_t k = 0; k < m->count; k++) {
		struct signal *s = &e->table.signals[m->items[k]->row];

		engine_alarm_polled(e, m->items[k]);
		engine_read_at(e, s, e->time.period + 1);
		engine_publish(e, s);
	}
}

bool alarm_is_arming(uint8_t unarmed)
{
	return unarmed == OWS_UNARMED_SET || unarmed == OWS_UNARMED_POR;
}

static bool is_dead(uint8_t unarmed)
{
	return unarmed == OWS_UNARMED_NO_POR || unarmed == OWS_UNARMED_NO_LATCH;
}

static uint32_t unarmed_flags(uint8_t unarmed)
{
	return OWS_ATTR_ALARM_UNARMED | (uint32_t)(unarmed - 1) << OWS_ATTR_ALARM_WHY_SHIFT;
}

static void alarm_refused_enter(struct engine *e, const struct signal *s, uint8_t unarmed, int err)
{
	struct ows_journal_entry entry = signal_entry(s, OWS_ALARM_DEVICE, OWS_ALARM_FAILED,
	                                              e->time.now_ns);

	snprintf(entry.text, sizeof(entry.text), err ? "%s: %s: %s" : "%s", unarmed_text(unarmed),
	         unarmed_key(unarmed), error_text(err));
	image_alarm(e->image, &entry);
}

void alarm_show(struct engine *e, struct alarm_item *i, enum ows_unarmed unarmed, int err,
                const char *property, const char *why)
{
	struct signal *s = alarm_signal(e, i);
	uint8_t before = unarmed_of(s->attrs.flags);
	bool missing = !err || err == -EBADRQC;

	if (is_dead(before))
		return;
	/* one at a time: the other is shown when this one is over */
	if (before && alarm_is_arming(before) != alarm_is_arming(unarmed))
		return;
	s->attrs.flags &= ~(uint32_t)OWS_ATTR_ALARM_WHY;
	s->attrs.flags |= unarmed_flags((uint8_t)unarmed);
	s->alarm_err = err;
	if (!before) {
		log_warning(e->log, "%s (%s): the alarm %s%s: %s%s%s%s%s", s->item->name,
		            s->item->path, err ? "" : "is ", unarmed_text(unarmed),
		            missing ? "" : unarmed_key(unarmed), missing ? "" : ": ", property, why,
		            missing ? "" : error_text(err));
		alarm_refused_enter(e, s, unarmed, err);
		engine_read_now(e, s);
	}
	engine_publish(e, s);
}

void alarm_hide(struct engine *e, struct alarm_item *i)
{
	struct signal *s = alarm_signal(e, i);

	if (is_dead(unarmed_of(s->attrs.flags)))
		return;
	s->attrs.flags &= ~(uint32_t)(OWS_ATTR_ALARM_UNARMED | OWS_ATTR_ALARM_WHY);
	s->alarm_err = 0;
	engine_publish(e, s);
}

bool alarm_show_dead(struct engine *e, const struct alarm_item *i)
{
	const struct alarm_strings *strings = &i->strings;
	uint8_t why = !strings->por                         ? OWS_UNARMED_NO_POR
	              : !strings->latch || !*strings->latch ? OWS_UNARMED_NO_LATCH
	                                                    : 0;

	if (why)
		alarm_signal(e, i)->attrs.flags |= unarmed_flags(why);
	return why != 0;
}

/* --- Requests of a visit --------------------------------------------------------------------- */

void alarm_visit_anew(struct engine *e, struct alarm_item *i)
{
	uint8_t shown = unarmed_of(alarm_signal(e, i)->attrs.flags);

	i->visit = (struct alarm_visit){0};
	if (shown && !alarm_is_arming(shown))
		alarm_hide(e, i);
}

bool alarm_of_device(int err)
{
	return err == -ENODEV || err == -ECOMM;
}

void alarm_refused(struct lane *lane, struct alarm_item *i, enum ows_unarmed unarmed, int err,
                   const char *property, const char *why)
{
	struct engine *e = lane->engine;
	int64_t wait_ns;

	if (err && !alarm_of_device(err))
		lane->counters.item_errors++;
	if (i->visit.refused != unarmed)
		alarm_visit_anew(e, i);
	i->visit.refused = unarmed;
	if (!retry_fail(&i->visit.retry, e->config->max_retries, &wait_ns))
		return;
	i->visit.not_before_ns = e->time.now_ns + wait_ns;
	if (!alarm_of_device(err))
		alarm_show(e, i, unarmed, err, property, why);
}

void alarm_granted(struct engine *e, struct alarm_item *i, uint8_t unarmed)
{
	const struct signal *s = alarm_signal(e, i);

	if (!unarmed || i->visit.refused != unarmed)
		return;
	if (unarmed_of(s->attrs.flags) == unarmed)
		log_notice(e->log, "%s (%s): the alarm can be %s again", s->item->name,
		           s->item->path, unarmed_verb(unarmed));
	alarm_visit_anew(e, i);
}
