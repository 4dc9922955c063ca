/* SPDX-License-Identifier: MIT */
/*
 * The arming of alarm items: SetAlarm compared with the chip, and a restart of a device, which is
 * one restart as long as its por cannot be cleared (docs/semantics.md, section 4, "One restart").
 */
#include <errno.h>
#include <string.h>

#include "src/daemon/engine/alarm/alarm_arm.h"
#include "src/daemon/engine/alarm/alarm_effect.h"
#include "src/daemon/engine/alarm/alarm_item.h"
#include "src/daemon/engine/alarm/alarm_text.h"
#include "src/daemon/engine/retry.h"
#include "src/ground/signal/unarmed.h"
#include "src/ground/text/log.h"

/* Another item of the same device, or this one, with the same property for its restart. */
static bool same_por(const struct alarm_item *a, const struct alarm_item *b)
{
	return a->device == b->device && a->strings.por && b->strings.por &&
	       strcmp(a->strings.por, b->strings.por) == 0;
}

bool alarm_takes_part(const struct alarm_item *i, int64_t now_ns)
{
	return i->asks_por || (i->listed && now_ns >= i->visit.not_before_ns &&
	                       !(i->restart.known && now_ns < i->arming.not_before_ns));
}

/* Arming begins anew, without the failures so far. True: the signal was shown as not armed. */
static bool arm_anew(struct engine *e, struct alarm_item *i)
{
	retry_clear(&i->arming.retry);
	i->arming.not_before_ns = 0;
	if (!alarm_is_arming(unarmed_of(alarm_signal(e, i)->attrs.flags)))
		return false;
	alarm_hide(e, i);
	return true;
}

static void report_armed(struct engine *e, struct alarm_item *i)
{
	const struct signal *s = alarm_signal(e, i);

	if (arm_anew(e, i))
		log_notice(e->log, "%s (%s): the alarm is armed again", s->item->name,
		           s->item->path);
}

static void count_unarmed(struct lane *lane, struct alarm_item *i, int err, const char *property,
                          const char *why)
{
	struct engine *e = lane->engine;
	int64_t wait_ns;

	if (err != -ENODEV || !e->table.devices[i->device].absent)
		lane->counters.item_errors++;
	if (!retry_fail(&i->arming.retry, e->config->max_retries, &wait_ns))
		return;
	i->arming.not_before_ns = e->time.now_ns + wait_ns;
	if (err != -ENODEV) /* its quality says so */
		alarm_show(e, i, property == i->strings.por ? OWS_UNARMED_POR : OWS_UNARMED_SET,
		           err, property, why);
}

/* --- Restarts -------------------------------------------------------------------------------- */

void alarm_por_set(struct alarm_machine *m, struct lane *lane, struct alarm_item *i)
{
	if (i->restart.known && !i->restart.differs)
		return;
	engine_power_on_reset(lane, &lane->engine->table.devices[i->device],
	                      &lane->engine->table.signals[i->row], i->restart.seen);
	for (uint32_t k = 0; k < m->count; k++) {
		struct alarm_item *other = m->items[k];

		if (!same_por(other, i))
			continue;
		if (!other->restart.known) {
			retry_clear(&other->arming.retry);
			other->arming.not_before_ns = 0;
		}
		other->restart.seen = other->restart.known = true;
		other->restart.differs = false;
	}
}

/* Another restart while por stood leaves no trace, but in outputs that were written meanwhile. */
static void doubt_outputs(struct engine *e, const struct device *d)
{
	for (uint32_t k = 0; k < d->count; k++)
		d->signals[k]->command.unproven_ns = e->time.now_ns;
}

void alarm_por_clear(struct alarm_machine *m, struct engine *e, const struct alarm_item *i)
{
	if (i->restart.known)
		doubt_outputs(e, &e->table.devices[i->device]);
	for (uint32_t k = 0; k < m->count; k++) {
		struct alarm_item *other = m->items[k];

		if (!same_por(other, i))
			continue;
		other->restart.seen = true;
		if (!other->restart.known)
			continue;
		other->restart.known = other->restart.differs = false;
		if (!other->arming.wanted)
			report_armed(e, other);
		else
			other->arming.not_before_ns = 0;
	}
}

void alarm_set_failed(struct lane *lane, struct alarm_item *i, int err)
{
	i->arming.wanted = alarm_arms(i);
	count_unarmed(lane, i, err, i->strings.set, " cannot be written: ");
}

void alarm_set_missing(struct lane *lane, struct alarm_item *i)
{
	if (i->restart.known) /* another item of the device may have ended it in this cycle */
		count_unarmed(lane, i, -EBADRQC, "SetAlarm",
		              i->strings.set ? " has no '='" : " is not defined");
}

void alarm_por_failed(struct lane *lane, struct alarm_item *i, int err)
{
	count_unarmed(lane, i, err, i->strings.por, " cannot be set to 0: ");
}

void alarm_rearm(struct alarm_machine *m, struct engine *e, uint32_t device)
{
	for (uint32_t k = 0; k < m->count; k++) {
		struct alarm_item *i = m->items[k];

		if (i->device != device)
			continue;
		i->arming.wanted = alarm_arms(i);
		i->arming.cycle = m->list.cycle;
		i->restart.known = i->restart.differs = i->asks_por = false;
		arm_anew(e, i);
		alarm_visit_anew(e, i);
	}
}

/* --- SetAlarm at start, and when a device comes back ------------------------------------------ */

/* A list comes first: what has por set gets its SetAlarm by that, in ALARM_SET. */
static bool wants_arming(const struct alarm_machine *m, const struct alarm_item *i)
{
	return i->arming.wanted && !i->restart.known && i->arming.cycle != m->list.cycle;
}

struct alarm_item *alarm_to_arm(const struct alarm_machine *m, int64_t now_ns)
{
	for (uint32_t k = 0; k < m->count; k++)
		if (wants_arming(m, m->items[k]) && now_ns >= m->items[k]->arming.not_before_ns)
			return m->items[k];
	return NULL;
}

int64_t alarm_to_arm_ns(const struct alarm_machine *m)
{
	int64_t next_ns = INT64_MAX;

	for (uint32_t k = 0; k < m->count; k++)
		if (wants_arming(m, m->items[k]))
			next_ns = earlier_ns(next_ns, m->items[k]->arming.not_before_ns);
	return next_ns;
}

void alarm_arm_answered(struct alarm_machine *m, struct lane *lane, const struct bus_answer *answer,
                        const char *data)
{
	struct alarm_item *i = m->arming;
	bool wrote = m->arm_writes;
	int err = answer->err;

	/* what cannot be read may be written all the same */
	if (!wrote &&
	    (err == -EACCES || (!err && !alarm_as_set(data, answer->len, i->strings.set_value)))) {
		m->arm_writes = true;
		return;
	}
	m->arming = NULL;
	m->arm_writes = false;
	if (!err) {
		i->arming.wanted = false;
		report_armed(lane->engine, i);
	} else if (failure_of(err) == FAILURE_ITEM) {
		count_unarmed(lane, i, err, i->strings.set,
		              wrote ? " cannot be written: " : " cannot be read: ");
	}
}
