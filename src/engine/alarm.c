/* SPDX-License-Identifier: MIT */
/* The alarm machine of a lane: from state to state, and what each answer means. */
#include <errno.h>
#include <string.h>

#include "hal/bus/time.h"
#include "src/engine/alarm.h"
#include "src/engine/alarm_arm.h"
#include "src/engine/alarm_ask.h"
#include "src/engine/alarm_effect.h"
#include "src/engine/alarm_known.h"
#include "src/engine/alarm_list.h"
#include "src/engine/alarm_refused.h"
#include "src/engine/alarm_text.h"
#include "src/engine/completion.h"
#include "src/engine/publish.h"
#include "src/engine/schedule.h"
#include "src/engine/state.h"
#include "src/shm/entries.h"
#include "src/signal/value.h"
#include "src/text/log.h"

#define BYPASS_NS (20 * NS_PER_MS)

static uint32_t defined_fact(const char *name, const char *value)
{
	if (!name || !value)
		return FACT_ND;
	return *name && *value ? 0 : FACT_EMPTY;
}

static uint32_t sensed_facts(struct engine *e, const struct alarm_item *i)
{
	if (!i->strings.has_sensed || !signal_reads(alarm_signal(e, i)))
		return FACT_EMPTY;
	return 0;
}

/* --- Facts of the states that need no answer ------------------------------------------------- */

static uint32_t process_facts(struct alarm_machine *m, struct engine *e, int64_t now_ns)
{
	if (m->in_a_row >= e->config->max_cons_alarms)
		return FACT_MAX_CONS;
	while (++m->position < (int64_t)m->count)
		if (alarm_takes_part(m->items[m->position], now_ns)) {
			m->in_a_row++;
			return FACT_NEXT_ITEM;
		}
	m->position = -1;
	return FACT_CYCLE_END;
}

/*
 * What an overlapping bus has may wait for a conversion and leave the wire idle; the alarms do not
 * wait for that. A bus that could do something else has begun it by then.
 */
static uint32_t bypass_facts(struct alarm_machine *m, const struct lane *lane, int64_t now_ns)
{
	bool pending = lane->inputs.count || lane->outputs.count || lane->lent.writes ||
	               lane->lent.count > (m->in_work ? 1u : 0u);

	if (!m->bypass_ns)
		m->bypass_ns = now_ns + BYPASS_NS;
	if (!m->passed && pending && now_ns < m->bypass_ns)
		return 0;
	return FACT_PASSED | (m->position >= 0 ? FACT_POS : 0);
}

/* What is known of the state before its request is made. */
static uint32_t facts_before(struct alarm_machine *m, struct lane *lane, int64_t now_ns)
{
	struct engine *e = lane->engine;
	const struct alarm_item *i = alarm_current(m), *known;

	switch (m->state) {
	case ALARM_PROCESS:
		return process_facts(m, e, now_ns);
	case ALARM_BYPASS:
		return bypass_facts(m, lane, now_ns);
	case ALARM_POR_READ:
		known = alarm_known(m, i, ALARM_POR_WAS_READ);
		return defined_fact(i->strings.por, i->strings.por) | (known ? FACT_KNOWN : 0) |
		       (known && known->por_set ? FACT_NON_ZERO : 0);
	case ALARM_SET:
		return defined_fact(i->strings.set, i->strings.set_value) |
		       (alarm_known(m, i, ALARM_WAS_SET) ? FACT_KNOWN : 0);
	case ALARM_POR_RESET:
		return defined_fact(i->strings.por, i->strings.por) |
		       (alarm_known(m, i, ALARM_POR_WAS_RESET) ? FACT_KNOWN : 0);
	case ALARM_LATCH:
		known = alarm_known(m, i, ALARM_LATCH_WAS_READ);
		return defined_fact(i->strings.latch, i->strings.latch) | (known ? FACT_KNOWN : 0) |
		       (known && known->latch_set ? FACT_NON_ZERO : 0);
	case ALARM_SENSED:
	case SENSED:
		return sensed_facts(e, i);
	case ALARM_LATCH_RESET:
		return defined_fact(i->strings.reset, i->strings.reset_value) |
		       (alarm_known(m, i, ALARM_LATCH_WAS_RESET) ? FACT_KNOWN : 0);
	case ALARM_SET_WAIT: /* entered from ALARM_INIT_WRITE_WAIT: look for the next output */
		return alarm_next_init(e, m) >= 0 ? 0 : FACT_DONE;
	case NOT_USED:
	case INIT:
	case ALARM_DIR:
	case ALARM_POR_READ_WAIT:
	case ALARM_INIT_WRITE_WAIT:
	case ALARM_POR_RESET_WAIT:
	case ALARM_LATCH_WAIT:
	case ALARM_SENSED_WAIT:
	case ALARM_LATCH_RESET_WAIT:
	case SENSED_WAIT:
		break;
	}
	return 0;
}

/* --- From state to state ---------------------------------------------------------------------- */

static void enter_state(struct alarm_machine *m, struct lane *lane, const struct alarm_row *row)
{
	log_debug(lane->engine->log, "%s: alarms: from %s to %s: %s", lane->port->target,
	          alarm_state_name(m->state), alarm_state_name(row->next), row->text);
	m->state = row->next;
	if (m->state == ALARM_BYPASS) {
		m->passed = false;
		m->bypass_ns = 0;
		m->in_a_row = 0;
	}
}

bool alarm_run(struct alarm_machine *m, struct lane *lane, struct alarm_request *request,
               int64_t now_ns)
{
	const struct alarm_row *row;

	/* a cycle without requests ends in INIT or ALARM_BYPASS: bounded */
	while (m->state != NOT_USED && !m->in_work) {
		bool between = m->collecting >= 0 || m->proving;
		uint32_t facts = between ? 0 : facts_before(m, lane, now_ns);

		row = facts ? alarm_next(m->state, facts) : NULL;
		if (!row)
			return alarm_ask(m, lane, request, now_ns);
		if (facts & FACT_KNOWN)
			alarm_granted(lane->engine, alarm_current(m), alarm_asks(m->state));
		if (m->state == ALARM_SET && facts & FACT_ND)
			alarm_set_missing(lane, alarm_current(m), now_ns);
		if (m->state == ALARM_LATCH && facts & FACT_KNOWN) {
			/* the value that another item of the device has read */
			struct alarm_item *i = alarm_current(m);
			const struct alarm_item *known = alarm_known(m, i, ALARM_LATCH_WAS_READ);

			i->latch_set = known->latch_set;
			memcpy(i->occurrence.latch_text, known->occurrence.latch_text,
			       sizeof(i->occurrence.latch_text));
			if (i->latch_set)
				engine_alarm_raised(lane->engine, lane, i, now_ns);
			else
				engine_alarm_rests(lane->engine, i, now_ns);
		}
		enter_state(m, lane, row);
	}
	return false;
}

void alarm_started(struct alarm_machine *m, struct lane *lane, int64_t now_ns)
{
	uint32_t facts = FACT_STARTED;

	m->in_work = true;
	if (m->collecting >= 0 || m->arming >= 0 || m->proving)
		return;
	if (m->state == INIT) {
		m->list.next_ns = now_ns + lane->engine->config->alarm_period_ns;
	} else if (m->state == ALARM_SET_WAIT) {
		m->init_position = alarm_next_init(lane->engine, m);
		facts = FACT_DONE | FACT_INIT_OUTPUT;
	} else if (m->state == ALARM_SET) {
		m->init_position = -1;
	}
	enter_state(m, lane, alarm_next(m->state, facts));
}

/* --- Answers --------------------------------------------------------------------------------- */

static int take_latch(struct alarm_machine *m, struct alarm_item *i,
                      const struct bus_answer *answer, const char *data)
{
	int set = answer->err ? answer->err : alarm_non_zero(data, answer->len);

	if (set < 0)
		return set;
	i->cycle_of[ALARM_LATCH_WAS_READ] = m->list.cycle;
	i->latch_set = set;
	alarm_trim(i->occurrence.latch_text, sizeof(i->occurrence.latch_text), data, answer->len);
	return 0;
}

/* The value read under an alarm; 0 or the item error. */
static int take_alarm_value(struct engine *e, struct lane *lane, struct alarm_item *item,
                            const struct slot *slot, const struct bus_answer *answer,
                            int64_t now_ns)
{
	struct signal *s = &e->table.signals[item->row];
	int64_t wait_ns;
	int err;

	if (!signal_reads(s))
		return 0;
	err = engine_take_reading(e, lane, s, slot, answer, now_ns, &wait_ns);
	if (wait_ns)
		item->visit.not_before_ns = now_ns + wait_ns;
	if (!err && item->occurrence.wants_after && !signal_is_string(s)) {
		image_alarm_after(e->image, item->occurrence.journal, s->sample.value);
		item->occurrence.wants_after = false;
	}
	engine_publish(e, s);
	return err;
}

/* What the answer means to the state; side effects on table and journal included. */
static uint32_t facts_after(struct alarm_machine *m, struct lane *lane, const struct slot *slot,
                            const struct bus_answer *answer, int64_t now_ns)
{
	struct engine *e = lane->engine;
	struct alarm_item *i = alarm_current(m);
	const char *data = m->state == ALARM_DIR ? lane->lent.list : (const char *)slot->data;
	int err = answer->err, set;

	switch (m->state) {
	case ALARM_DIR:
		if (!err)
			alarm_take_list(m, lane, data, answer->len, now_ns);
		else
			alarm_list_failed(m, lane, err, now_ns);
		break;
	case ALARM_POR_READ_WAIT:
		i->asks_por = false;
		set = err ? err : alarm_non_zero(data, answer->len);
		err = set < 0 ? set : 0;
		if (err)
			break;
		alarm_granted(e, i, OWS_UNARMED_POR_READ);
		i->cycle_of[ALARM_POR_WAS_READ] = m->list.cycle;
		i->por_set = set;
		if (set)
			alarm_por_set(m, lane, i);
		else
			alarm_por_clear(m, e, i);
		return FACT_DONE | (set ? FACT_NON_ZERO : 0);
	case ALARM_SET_WAIT:
		if (err) {
			alarm_set_failed(lane, i, err, now_ns);
			return FACT_FAILED;
		} else {
			i->cycle_of[ALARM_WAS_SET] = m->list.cycle;
			i->arming.wanted = false;
			if (alarm_known(m, i, ALARM_INIT_WAS_WRITTEN) || alarm_next_init(e, m) < 0)
				return FACT_DONE;
			i->cycle_of[ALARM_INIT_WAS_WRITTEN] = m->list.cycle;
			return 0; /* the first output is asked for from here */
		}
	case ALARM_INIT_WRITE_WAIT:
		engine_write_done(e, lane, slot, answer, now_ns);
		return (err ? FACT_FAILED : FACT_DONE) |
		       (m->init_position >= 0 ? FACT_INIT_POS : 0);
	case ALARM_POR_RESET_WAIT:
		m->proving = !err;
		if (err)
			alarm_por_failed(lane, i, err, now_ns);
		return err ? FACT_FAILED : FACT_DONE;
	case ALARM_LATCH_WAIT:
		err = take_latch(m, i, answer, data);
		if (err)
			break;
		alarm_granted(e, i, OWS_UNARMED_LATCH);
		if (i->latch_set)
			engine_alarm_raised(e, lane, i, now_ns);
		else
			engine_alarm_rests(e, i, now_ns);
		return FACT_DONE | (i->latch_set ? FACT_NON_ZERO : 0);
	case ALARM_SENSED_WAIT:
	case SENSED_WAIT:
		err = take_alarm_value(e, lane, i, slot, answer, now_ns);
		if (err && m->state == SENSED_WAIT)
			engine_read_at(e, alarm_signal(e, i), e->time.period + 1);
		return err ? FACT_FAILED : FACT_DONE;
	case ALARM_LATCH_RESET_WAIT:
		if (!err) {
			i->cycle_of[ALARM_LATCH_WAS_RESET] = m->list.cycle;
			alarm_granted(e, i, OWS_UNARMED_RESET);
			i->occurrence.stands = false;
		}
		break;
	case NOT_USED:
	case INIT:
	case ALARM_PROCESS:
	case ALARM_POR_READ:
	case ALARM_SET:
	case ALARM_POR_RESET:
	case ALARM_LATCH:
	case ALARM_SENSED:
	case ALARM_LATCH_RESET:
	case SENSED:
	case ALARM_BYPASS:
		break;
	}
	if (err && i && alarm_of_device(err))
		engine_alarm_failed(e, lane, i, err);
	if (err && i)
		alarm_refused(lane, i, alarm_asks(m->state), err, now_ns);
	return err ? FACT_FAILED : FACT_DONE;
}

/*
 * Before the first reset of a device with several alarm items, every latch of it is read: the reset
 * of one would clear the others'.
 */
static bool begin_collecting(struct alarm_machine *m)
{
	const struct alarm_item *i = alarm_current(m);

	if (!i || (m->state != ALARM_POR_READ_WAIT && m->state != ALARM_LATCH_WAIT))
		return false;
	m->collecting = alarm_to_collect(m, i);
	return m->collecting >= 0;
}

/*
 * A driver may take the 0 and leave the flag set: then the next restart would look like this one.
 */
static uint32_t por_proven(struct alarm_machine *m, struct lane *lane,
                           const struct bus_answer *answer, const char *data, int64_t now_ns)
{
	struct alarm_item *i = alarm_current(m);
	int set = answer->err ? answer->err : alarm_non_zero(data, answer->len);

	m->proving = false;
	if (set) {
		alarm_por_failed(lane, i, set < 0 ? set : -EUCLEAN, now_ns);
		return FACT_FAILED;
	}
	i->cycle_of[ALARM_POR_WAS_RESET] = m->list.cycle;
	alarm_por_clear(m, lane->engine, i);
	return FACT_DONE;
}

void alarm_answered(struct alarm_machine *m, struct lane *lane, const struct slot *slot,
                    const struct bus_answer *answer, int64_t now_ns)
{
	uint32_t facts;

	m->in_work = false;
	if (m->arming >= 0) {
		alarm_arm_answered(m, lane, answer, (const char *)slot->data, now_ns);
		return;
	}
	if (failure_of(answer->err) == FAILURE_TARGET || answer->err == -ECANCELED ||
	    answer->err == -ETIME) {
		alarm_restart(m);
		return;
	}
	if (m->collecting >= 0) {
		struct alarm_item *other = m->items[m->collecting];

		/* what cannot be read now is asked for again by its own item */
		other->cycle_of[ALARM_WAS_COLLECTED] = m->list.cycle;
		take_latch(m, other, answer, (const char *)slot->data);
		m->collecting = alarm_to_collect(m, alarm_current(m));
		if (m->collecting < 0)
			enter_state(m, lane, alarm_next(m->state, m->held));
		return;
	}
	if (m->proving) {
		facts = por_proven(m, lane, answer, (const char *)slot->data, now_ns);
		enter_state(m, lane, alarm_next(m->state, facts));
		return;
	}
	facts = facts_after(m, lane, slot, answer, now_ns);
	if (m->state == NOT_USED || !facts || m->proving)
		return;
	m->held = facts;
	if (!(facts & FACT_DONE) || !begin_collecting(m))
		enter_state(m, lane, alarm_next(m->state, facts));
}

void alarm_passed(struct alarm_machine *m)
{
	m->passed = true;
}

bool alarm_holds(const struct alarm_machine *m)
{
	return m->in_work || (m->state != NOT_USED && m->state != INIT && m->state != ALARM_BYPASS);
}

int64_t alarm_wake(const struct alarm_machine *m)
{
	int64_t arm_ns;

	if (m->in_work)
		return INT64_MAX;
	if (m->state == ALARM_BYPASS)
		return m->bypass_ns;
	if (m->state != INIT)
		return INT64_MAX;
	arm_ns = alarm_to_arm_ns(m);
	return arm_ns < m->list.next_ns ? arm_ns : m->list.next_ns;
}
