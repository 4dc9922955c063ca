/* SPDX-License-Identifier: MIT */
/* The alarm machine of a lane: the list of /alarm, from state to state, what answers mean. */
#include <errno.h>
#include <string.h>

#include "hal/base/time.h"
#include "hal/owfs/path.h"
#include "src/daemon/engine/alarm/alarm.h"
#include "src/daemon/engine/alarm/alarm_arm.h"
#include "src/daemon/engine/alarm/alarm_effect.h"
#include "src/daemon/engine/alarm/alarm_step.h"
#include "src/daemon/engine/completion.h"
#include "src/daemon/engine/publish.h"
#include "src/daemon/engine/schedule.h"
#include "src/ground/text/log.h"

#define LIST_WAIT_MAX (60 * NS_PER_S)

static void mark_listed(struct alarm_machine *m, struct lane *lane, const char *entry, size_t len)
{
	struct engine *e = lane->engine;
	struct path path;
	bool ours = false;

	if (path_split(entry, len, &path) || !path.device.len)
		return;
	for (uint32_t k = 0; k < m->count; k++) {
		const struct device *d = &e->table.devices[m->items[k]->device];
		struct path own;

		if (path.has_rom && d->has_rom) {
			if (memcmp(path.rom, d->rom, sizeof(d->rom)))
				continue;
		} else {
			const char *text = m->items[k]->strings.path;

			if (path_split(text, strlen(text), &own) || !path_same_device(&path, &own))
				continue;
		}
		if (d->absent) /* it is there again */
			engine_read_now(e, alarm_signal(e, m->items[k]));
		m->items[k]->listed = ours = true;
		m->items[k]->asks_por = false;
	}
	if (ours || !path.has_rom)
		return;
	for (unsigned k = 0; k < m->list.strangers; k++)
		if (memcmp(m->list.stranger[k], path.rom, 8) == 0)
			return;
	if (m->list.strangers == sizeof(m->list.stranger) / sizeof(m->list.stranger[0]))
		return;
	memcpy(m->list.stranger[m->list.strangers++], path.rom, 8);
	log_info(e->log, "%s: %.*s is in alarm and has no alarm item", lane->port->target, (int)len,
	         entry);
}

static void parse_list(struct alarm_machine *m, struct lane *lane, const char *list, size_t len)
{
	m->list.cycle++;
	lane->counters.alarm_lists++;
	m->list.wait_ns = 0;
	for (uint32_t k = 0; k < m->count; k++) {
		struct alarm_item *i = m->items[k];
		struct signal *s = alarm_signal(lane->engine, i);

		if (s->sample.quality == OWS_Q_SHORT) /* it is no longer */
			engine_read_now(lane->engine, s);
		/* unless it is found below */
		i->asks_por = i->asks_por || (i->restart.known && i->listed);
		i->listed = false;
	}
	while (len) {
		const char *end = memchr(list, '\n', len);
		size_t n = end ? (size_t)(end - list) : len;

		mark_listed(m, lane, list, n);
		if (!end)
			break;
		len -= n + 1;
		list = end + 1;
	}
	for (uint32_t k = 0; k < m->count; k++)
		if (!m->items[k]->listed) {
			m->items[k]->restart.seen = true;
			alarm_granted(lane->engine, m->items[k], OWS_UNARMED_STAYS);
			engine_alarm_rests(lane->engine, m->items[k]);
		}
}

static void list_failed(struct alarm_machine *m, struct lane *lane, int err)
{
	struct engine *e = lane->engine;

	if (err == -EOPNOTSUPP) {
		log_at(e->log, m->list.logged ? LOG_LEVEL_DEBUG : LOG_LEVEL_NOTICE,
		       "%s: no alarm search: alarm items are read as ordinary inputs",
		       lane->port->target);
		m->list.polls = m->list.logged = true;
		m->state = NOT_USED;
		engine_alarm_polls(e, m);
		return;
	}
	m->list.wait_ns = m->list.wait_ns ? m->list.wait_ns * 2 : e->config->alarm_period_ns;
	if (m->list.wait_ns > LIST_WAIT_MAX)
		m->list.wait_ns = LIST_WAIT_MAX;
	m->list.next_ns = e->time.now_ns + m->list.wait_ns;
	m->position = -1;
	/* the wire is short: no device can say that it is in alarm, so no value stays good */
	for (uint32_t k = 0; k < m->count && err == -ECOMM; k++)
		engine_read_now(e, alarm_signal(e, m->items[k]));
}

void alarm_ask_again(struct alarm_machine *m, struct lane *lane)
{
	if (!m->list.polls)
		return;
	m->list.polls = false;
	m->list.next_ns = lane->engine->time.now_ns;
	if (m->count)
		m->state = alarm_next(NOT_USED, FACT_ITEMS)->next;
	for (uint32_t k = 0; k < m->count; k++) {
		struct signal *s = alarm_signal(lane->engine, m->items[k]);

		s->attrs.flags &= ~(uint32_t)OWS_ATTR_ALARM_POLLED;
		engine_publish(lane->engine, s);
	}
}

#define BYPASS_NS (20 * NS_PER_MS)

static uint32_t defined_fact(const char *name, const char *value)
{
	if (!name || !value)
		return FACT_ND;
	return *name && *value ? 0 : FACT_EMPTY;
}

/* --- Facts of the states that need no answer ------------------------------------------------- */

static uint32_t init_facts(const struct alarm_machine *m, const struct engine *e)
{
	bool arms = !m->arming && alarm_to_arm(m, e->time.now_ns);

	return arms && m->in_a_row >= e->config->max_cons_alarms ? FACT_MAX_CONS : 0;
}

static uint32_t process_facts(struct alarm_machine *m, struct engine *e)
{
	if (m->in_a_row >= e->config->max_cons_alarms)
		return FACT_MAX_CONS;
	while (++m->position < (int64_t)m->count)
		if (alarm_takes_part(m->items[m->position], e->time.now_ns)) {
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
static uint32_t bypass_facts(struct alarm_machine *m, const struct lane *lane)
{
	int64_t now_ns = lane->engine->time.now_ns;
	bool pending = lane->inputs.count || lane->outputs.count || lane->lent.writes ||
	               lane->lent.count > (m->in_work ? 1u : 0u);

	if (!m->bypass_ns)
		m->bypass_ns = now_ns + BYPASS_NS;
	if (!m->passed && pending && now_ns < m->bypass_ns)
		return 0;
	return FACT_PASSED | (m->position >= 0 ? FACT_POS : 0);
}

/* What is known of the state before its request is made. */
static uint32_t facts_before(struct alarm_machine *m, struct lane *lane)
{
	struct engine *e = lane->engine;
	const struct alarm_item *i = alarm_current(m), *known;
	const struct alarm_step *step = alarm_step(m->state);

	if (m->state == INIT)
		return init_facts(m, e);
	if (m->state == ALARM_PROCESS)
		return process_facts(m, e);
	if (m->state == ALARM_BYPASS)
		return bypass_facts(m, lane);
	if (m->state == ALARM_SET_WAIT) /* entered from ALARM_INIT_WRITE_WAIT: the next output */
		return alarm_next_init(e, m) >= 0 ? 0 : FACT_DONE;
	if (!step || step->asks != m->state)
		return 0;
	if (step->deed == ALARM_VALUE_WAS_READ && !signal_reads(alarm_signal(e, i)))
		return FACT_EMPTY;
	known = alarm_done(m, i, step);
	return defined_fact(alarm_string(&i->strings, step->property),
	                    step->value ? alarm_string(&i->strings, step->value) : "0") |
	       (known ? FACT_KNOWN : 0) | (known && known->set[step->deed] ? FACT_NON_ZERO : 0);
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

/* The latch that another item of the device has read. */
static void share_latch(struct alarm_machine *m, struct lane *lane)
{
	struct alarm_item *i = alarm_current(m);
	const struct alarm_item *known = alarm_done(m, i, alarm_step(ALARM_LATCH));

	i->set[ALARM_LATCH_WAS_READ] = known->set[ALARM_LATCH_WAS_READ];
	memcpy(i->occurrence.latch_text, known->occurrence.latch_text,
	       sizeof(i->occurrence.latch_text));
	alarm_show_latch(lane, i);
}

bool alarm_run(struct alarm_machine *m, struct lane *lane, struct slot *slot)
{
	const struct alarm_row *row;

	/* a cycle without requests ends in INIT or ALARM_BYPASS: bounded */
	while (m->state != NOT_USED && !m->in_work) {
		bool between = m->collecting || m->proving;
		uint32_t facts = between ? 0 : facts_before(m, lane);

		row = facts ? alarm_next(m->state, facts) : NULL;
		if (!row)
			return alarm_ask(m, lane, slot);
		if (facts & FACT_KNOWN)
			alarm_granted(lane->engine, alarm_current(m),
			              alarm_step(m->state)->unarmed);
		if (m->state == ALARM_SET && facts & FACT_ND)
			alarm_set_missing(lane, alarm_current(m));
		if (m->state == ALARM_LATCH && facts & FACT_KNOWN)
			share_latch(m, lane);
		enter_state(m, lane, row);
	}
	return false;
}

void alarm_started(struct alarm_machine *m, struct lane *lane)
{
	uint32_t facts = FACT_STARTED;

	m->in_work = true;
	m->yielded = 0;
	if (m->arming)
		m->in_a_row += !m->arm_writes;
	if (m->collecting || m->arming || m->proving)
		return;
	if (m->state == INIT) {
		m->anew = false;
		m->list.next_ns = lane->engine->time.now_ns + lane->engine->config->alarm_period_ns;
	} else if (m->state == ALARM_SET_WAIT) {
		m->init_position = alarm_next_init(lane->engine, m);
		facts = FACT_DONE | FACT_INIT_OUTPUT;
	} else if (m->state == ALARM_SET) {
		m->init_position = -1;
	}
	enter_state(m, lane, alarm_next(m->state, facts));
}

/* --- Answers --------------------------------------------------------------------------------- */

/* What the answer means to the state; side effects on table and journal included. */
static uint32_t facts_after(const struct alarm_answer *a)
{
	struct alarm_machine *m = a->m;
	int err = a->answer->err;

	if (m->state == ALARM_DIR && err)
		list_failed(m, a->lane, err);
	else if (m->state == ALARM_DIR)
		parse_list(m, a->lane, a->lane->lent.list, a->answer->len);
	else if (m->state != ALARM_INIT_WRITE_WAIT)
		return alarm_step(m->state)->take(a);
	else
		engine_write_done(a->lane->engine, a->lane, a->slot, a->answer);
	return (err ? FACT_FAILED : FACT_DONE) | (m->init_position >= 0 ? FACT_INIT_POS : 0);
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
	return m->collecting;
}

/*
 * A driver may take the 0 and leave the flag set: then the next restart would look like this one.
 */
static uint32_t por_proven(const struct alarm_answer *a)
{
	int set = alarm_flag(a);

	a->m->proving = false;
	if (set) {
		alarm_por_failed(a->lane, a->item, set < 0 ? set : -EUCLEAN);
		return FACT_FAILED;
	}
	a->item->cycle_of[ALARM_POR_WAS_RESET] = a->m->list.cycle;
	alarm_por_clear(a->m, a->lane->engine, a->item);
	return FACT_DONE;
}

void alarm_answered(struct alarm_machine *m, struct lane *lane, const struct slot *slot,
                    const struct bus_answer *answer)
{
	struct alarm_answer a = {m, lane, alarm_current(m), slot, answer};
	uint32_t facts;

	m->in_work = false;
	if (m->arming) {
		alarm_arm_answered(m, lane, answer, (const char *)slot->data);
		return;
	}
	if (failure_of(answer->err) == FAILURE_TARGET || answer->err == -ECANCELED ||
	    answer->err == -ETIME) {
		alarm_restart(m);
		return;
	}
	if (m->collecting) {
		a.item = m->collecting;
		/* what cannot be read now is asked for again by its own item */
		a.item->cycle_of[ALARM_WAS_COLLECTED] = m->list.cycle;
		alarm_keep_latch(&a);
		m->collecting = alarm_to_collect(m, alarm_current(m));
		if (!m->collecting)
			enter_state(m, lane, alarm_next(m->state, m->held));
		return;
	}
	if (m->proving) {
		enter_state(m, lane, alarm_next(m->state, por_proven(&a)));
		return;
	}
	facts = facts_after(&a);
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

bool alarm_yields(struct alarm_machine *m, const struct lane *lane)
{
	if (m->state != INIT || m->in_work || m->arming || !lane->outputs.count ||
	    m->yielded >= lane->writers ||
	    (!m->anew && !alarm_to_arm(m, lane->engine->time.now_ns)))
		return false;
	m->yielded++;
	return true;
}

bool alarm_holds(const struct alarm_machine *m)
{
	return m->in_work || (m->state != NOT_USED && m->state != INIT && m->state != ALARM_BYPASS);
}

int64_t alarm_wake(const struct alarm_machine *m)
{
	if (m->in_work)
		return INT64_MAX;
	if (m->state == ALARM_BYPASS)
		return m->bypass_ns;
	return m->state == INIT ? earlier_ns(alarm_to_arm_ns(m), m->list.next_ns) : INT64_MAX;
}
