/* SPDX-License-Identifier: MIT */
/*
 * Requests of the alarm machine that fail: the signal, the log and the journal name the key and the
 * property, and the item waits as a signal that cannot be read does.
 */
#include <errno.h>
#include <stdio.h>

#include "src/daemon/engine/alarm/alarm_effect.h"
#include "src/daemon/engine/alarm/alarm_refused.h"
#include "src/daemon/engine/publish.h"
#include "src/daemon/engine/retry.h"
#include "src/daemon/engine/schedule.h"
#include "src/ground/signal/error.h"
#include "src/ground/signal/unarmed.h"
#include "src/ground/text/log.h"
#include "src/memory/shm/entries.h"

uint8_t alarm_shown(const struct signal *s)
{
	if (!(s->attrs.flags & OWS_ATTR_ALARM_UNARMED))
		return 0;
	return (uint8_t)(1 + ((s->attrs.flags & OWS_ATTR_ALARM_WHY) >> OWS_ATTR_ALARM_WHY_SHIFT));
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
	uint8_t before = alarm_shown(s);
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

	if (is_dead(alarm_shown(s)))
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
	uint8_t shown = alarm_shown(alarm_signal(e, i));

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
	if (alarm_shown(s) == unarmed)
		log_notice(e->log, "%s (%s): the alarm can be %s again", s->item->name,
		           s->item->path, unarmed_verb(unarmed));
	alarm_visit_anew(e, i);
}
