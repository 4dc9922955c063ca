/* SPDX-License-Identifier: MIT */
/* The rows of a visit's steps, what their answers mean, and the requests of the alarm machine. */
#include <assert.h>
#include <stdio.h>
#include <string.h>

#include "src/daemon/engine/alarm/alarm_arm.h"
#include "src/daemon/engine/alarm/alarm_effect.h"
#include "src/daemon/engine/alarm/alarm_item.h"
#include "src/daemon/engine/alarm/alarm_step.h"
#include "src/daemon/engine/alarm/alarm_text.h"
#include "src/daemon/engine/completion.h"
#include "src/daemon/engine/publish.h"
#include "src/daemon/engine/scaling.h"
#include "src/daemon/engine/schedule.h"
#include "src/memory/shm/entries.h"
#include "src/public/ows_layout.h"

/* --- Answers ---------------------------------------------------------------------------------- */

int alarm_flag(const struct alarm_answer *a)
{
	return a->answer->err ? a->answer->err
	                      : alarm_non_zero((const char *)a->slot->data, a->answer->len);
}

static void mark_done(const struct alarm_answer *a, enum alarm_deed deed)
{
	a->item->cycle_of[deed] = a->m->list.cycle;
}

static uint32_t alarm_step_fail(const struct alarm_answer *a, int err)
{
	const struct alarm_step *step = alarm_step(a->m->state);
	struct engine *e = a->lane->engine;
	struct signal *s = alarm_signal(e, a->item);
	int64_t wait_ns;

	assert(step); /* an answer comes while one waits */
	if (alarm_of_device(err)) {
		wait_ns = engine_read_failed(e, a->lane, s, err);
		engine_read_at(e, s, e->time.period + (wait_ns ? engine_periods(e, wait_ns) : 1));
	}
	alarm_refused(a->lane, a->item, step->unarmed, err,
	              alarm_string(&a->item->strings, step->property),
	              step->op == BUS_WRITE ? " cannot be written: " : " cannot be read: ");
	return FACT_FAILED;
}

static uint32_t por_answer(const struct alarm_answer *a)
{
	struct engine *e = a->lane->engine;
	int set = alarm_flag(a);

	a->item->asks_por = false;
	if (set < 0)
		return alarm_step_fail(a, set);
	alarm_granted(e, a->item, OWS_UNARMED_POR_READ);
	mark_done(a, ALARM_POR_WAS_READ);
	a->item->set[ALARM_POR_WAS_READ] = set;
	if (set)
		alarm_por_set(a->m, a->lane, a->item);
	else
		alarm_por_clear(a->m, e, a->item);
	return FACT_DONE | (set ? FACT_NON_ZERO : 0);
}

static uint32_t set_answer(const struct alarm_answer *a)
{
	if (a->answer->err) {
		alarm_set_failed(a->lane, a->item, a->answer->err);
		return FACT_FAILED;
	}
	mark_done(a, ALARM_WAS_SET);
	a->item->arming.wanted = false;
	if (alarm_done(a->m, a->item, &(struct alarm_step){.deed = ALARM_INIT_WAS_WRITTEN}) ||
	    alarm_next_init(a->lane->engine, a->m) < 0)
		return FACT_DONE;
	mark_done(a, ALARM_INIT_WAS_WRITTEN);
	return 0; /* the first output is asked for from here */
}

static uint32_t por_reset_answer(const struct alarm_answer *a)
{
	a->m->proving = !a->answer->err;
	if (!a->answer->err)
		return FACT_DONE;
	alarm_por_failed(a->lane, a->item, a->answer->err);
	return FACT_FAILED;
}

int alarm_keep_latch(const struct alarm_answer *a)
{
	struct alarm_occurrence *o = &a->item->occurrence;
	int set = alarm_flag(a);

	if (set < 0)
		return set;
	mark_done(a, ALARM_LATCH_WAS_READ);
	a->item->set[ALARM_LATCH_WAS_READ] = set;
	alarm_trim(o->latch_text, sizeof(o->latch_text), (const char *)a->slot->data,
	           a->answer->len);
	return 0;
}

uint32_t alarm_show_latch(struct lane *lane, struct alarm_item *i)
{
	struct engine *e = lane->engine;

	if (!i->set[ALARM_LATCH_WAS_READ]) {
		alarm_granted(e, i, OWS_UNARMED_STAYS);
		engine_alarm_rests(e, i);
	} else {
		if (alarm_signal(e, i)->item->latch_stays && i->occurrence.entered)
			alarm_refused(lane, i, OWS_UNARMED_STAYS, 0, i->strings.latch,
			              " stays set; owsd --check names what clears it");
		engine_alarm_raised(e, lane, i);
	}
	return FACT_DONE | (i->set[ALARM_LATCH_WAS_READ] ? FACT_NON_ZERO : 0);
}

static uint32_t latch_answer(const struct alarm_answer *a)
{
	int err = alarm_keep_latch(a);

	if (err)
		return alarm_step_fail(a, err);
	alarm_granted(a->lane->engine, a->item, OWS_UNARMED_LATCH);
	return alarm_show_latch(a->lane, a->item);
}

/* The value read under an alarm. */
static uint32_t alarm_value_answer(const struct alarm_answer *a)
{
	struct engine *e = a->lane->engine;
	struct alarm_item *i = a->item;
	struct signal *s = alarm_signal(e, i);
	int64_t wait_ns;
	int err;

	if (!signal_reads(s))
		return FACT_DONE;
	err = engine_apply_reading(e, a->lane, s, a->slot, a->answer, &wait_ns);
	if (wait_ns)
		i->visit.not_before_ns = e->time.now_ns + wait_ns;
	if (!err && i->occurrence.wants_after && !signal_is_string(s)) {
		image_alarm_after(e->image, i->occurrence.journal, s->sample.value);
		i->occurrence.wants_after = false;
	}
	engine_publish(e, s);
	if (!err)
		engine_read_next(e, a->lane, s, a->slot);
	else if (a->m->state == SENSED_WAIT)
		engine_read_at(e, s, e->time.period + 1);
	return err ? FACT_FAILED : FACT_DONE;
}

static uint32_t latch_reset_answer(const struct alarm_answer *a)
{
	if (a->answer->err)
		return alarm_step_fail(a, a->answer->err);
	mark_done(a, ALARM_LATCH_WAS_RESET);
	alarm_granted(a->lane->engine, a->item, OWS_UNARMED_RESET);
	a->item->occurrence.stands = false;
	return FACT_DONE;
}

/* --- The steps -------------------------------------------------------------------------------- */

#define OF(member) offsetof(struct alarm_strings, member)

static const struct alarm_step steps[] = {
	{ALARM_POR_READ, ALARM_POR_READ_WAIT, BUS_READ, "", OF(por), OF(por), ALARM_POR_WAS_READ,
         OWS_UNARMED_POR_READ, por_answer},
	{ALARM_SET, ALARM_SET_WAIT, BUS_WRITE, "", OF(set), OF(set_value), ALARM_WAS_SET, 0,
         set_answer},
	{ALARM_POR_RESET, ALARM_POR_RESET_WAIT, BUS_WRITE, "", OF(por), 0, ALARM_POR_WAS_RESET, 0,
         por_reset_answer},
	{ALARM_LATCH, ALARM_LATCH_WAIT, BUS_READ, "", OF(latch), OF(latch), ALARM_LATCH_WAS_READ,
         OWS_UNARMED_LATCH, latch_answer},
	{ALARM_SENSED, ALARM_SENSED_WAIT, BUS_READ, "/alarm", OF(sensed), OF(sensed),
         ALARM_VALUE_WAS_READ, 0, alarm_value_answer},
	{ALARM_LATCH_RESET, ALARM_LATCH_RESET_WAIT, BUS_WRITE, "/alarm", OF(reset), OF(reset_value),
         ALARM_LATCH_WAS_RESET, OWS_UNARMED_RESET, latch_reset_answer},
	{SENSED, SENSED_WAIT, BUS_READ, "", OF(sensed), OF(sensed), ALARM_VALUE_WAS_READ, 0,
         alarm_value_answer},
};

const struct alarm_step *alarm_step(enum alarm_state state)
{
	for (size_t i = 0; i < sizeof(steps) / sizeof(steps[0]); i++)
		if (steps[i].asks == state || steps[i].waits == state)
			return &steps[i];
	return NULL;
}

static bool same_string(const struct alarm_item *x, const struct alarm_item *y, size_t at)
{
	const char *a = at ? alarm_string(&x->strings, at) : "";
	const char *b = at ? alarm_string(&y->strings, at) : "";

	return a && b && strcmp(a, b) == 0;
}

const struct alarm_item *alarm_done(const struct alarm_machine *m, const struct alarm_item *i,
                                    const struct alarm_step *step)
{
	assert(step);
	for (uint32_t k = 0; k < m->count; k++)
		if (m->items[k]->device == i->device &&
		    m->items[k]->cycle_of[step->deed] == m->list.cycle &&
		    same_string(m->items[k], i, step->property) &&
		    same_string(m->items[k], i, step->value))
			return m->items[k];
	return NULL;
}

struct alarm_item *alarm_to_collect(const struct alarm_machine *m, const struct alarm_item *i)
{
	for (uint32_t k = 0; k < m->count; k++) {
		struct alarm_item *other = m->items[k];
		const char *latch = other->strings.latch;

		if (other != i && other->device == i->device && latch && *latch &&
		    !same_string(other, i, OF(latch)) &&
		    other->cycle_of[ALARM_WAS_COLLECTED] != m->list.cycle &&
		    !alarm_done(m, other, alarm_step(ALARM_LATCH)))
			return other;
	}
	return NULL;
}

int64_t alarm_next_init(struct engine *e, struct alarm_machine *m)
{
	const struct alarm_item *current = alarm_current(m);
	const struct device *d;

	if (!current)
		return -1;
	d = &e->table.devices[current->device];
	for (uint32_t k = 0; k < d->count; k++) {
		const struct signal *s = d->signals[k];

		if (engine_row(s) > m->init_position && s->item->output && s->item->has_init &&
		    !s->item->starts_last && !s->command.confirmed && signal_writes(s) &&
		    !s->doubts)
			return engine_row(s);
	}
	return -1;
}

/* --- Requests --------------------------------------------------------------------------------- */

/* The step's request, or the read of what it writes. */
static bool ask_step(struct slot *slot, const struct alarm_item *i, const struct alarm_step *step,
                     enum bus_op op)
{
	const char *value;

	assert(step);
	value = step->value ? alarm_string(&i->strings, step->value) : "0";

	slot->req.op = (uint8_t)op;
	slot->row = i->row;
	snprintf(slot->path, sizeof(slot->path), "%s%s/%s", step->under, i->strings.path,
	         alarm_string(&i->strings, step->property));
	if (op == BUS_WRITE)
		slot->req.len = (uint32_t)snprintf((char *)slot->data, sizeof(slot->data), "%s",
		                                   value);
	return true;
}

static bool ask_init(struct engine *e, struct alarm_machine *m, struct slot *slot)
{
	int64_t row = alarm_next_init(e, m);
	const struct signal *s = &e->table.signals[row];
	const struct config_item *item = s->item;

	slot->row = (uint32_t)row;
	slot->req.path = item->path;
	signal_write(slot, s, item->init_value, item->init_text, strlen(item->init_text));
	return true;
}

/* An item with a SetAlarm that is to be compared with the chip comes before the list. */
static bool ask_list(struct alarm_machine *m, const struct lane *lane, struct slot *slot)
{
	int64_t now_ns = lane->engine->time.now_ns;

	m->position = -1;
	if (!m->arming)
		m->arming = alarm_to_arm(m, now_ns);
	if (m->arming)
		return ask_step(slot, m->arming, alarm_step(ALARM_SET),
		                m->arm_writes ? BUS_WRITE : BUS_READ);
	if (now_ns < m->list.next_ns)
		return false;
	if (!m->named)
		alarm_name_list(m, &lane->engine->table);
	slot->req.op = BUS_DIR;
	slot->req.path = m->list_path;
	slot->req.whole = m->whole;
	slot->row = TABLE_NO_ROW;
	return true;
}

bool alarm_ask(struct alarm_machine *m, const struct lane *lane, struct slot *slot)
{
	const struct alarm_step *step = alarm_step(m->state);

	if (m->collecting)
		return ask_step(slot, m->collecting, alarm_step(ALARM_LATCH), BUS_READ);
	if (m->proving)
		return ask_step(slot, alarm_current(m), step, BUS_READ);
	if (m->state == INIT)
		return ask_list(m, lane, slot);
	if (m->state == ALARM_SET_WAIT)
		return ask_init(lane->engine, m, slot);
	return step && step->asks == m->state && ask_step(slot, alarm_current(m), step, step->op);
}
