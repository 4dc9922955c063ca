/* SPDX-License-Identifier: MIT */
#include "alarm.h"

#include "hal/path.h"
#include "private.h"

#include "../signal/value.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LIST_WAIT_MAX 60000000000LL
#define BYPASS_NS 20000000LL

static struct signal *signal_of(struct engine *e, const struct alarm_item *item)
{
	return &e->table.signals[item->row];
}

static struct alarm_item *current(struct alarm_machine *m)
{
	return m->position < 0 ? NULL : &m->items[m->position];
}

/* The same device in the same cycle: what was done there need not be done again. */
static bool same(const char *a, const char *b)
{
	return a && b && strcmp(a, b) == 0;
}

static const struct alarm_item *por_known(const struct alarm_machine *m, const struct alarm_item *i)
{
	for (uint32_t k = 0; k < m->count; k++)
		if (m->items[k].device == i->device && m->items[k].por_cycle == m->cycle &&
		    same(m->items[k].strings.por, i->strings.por))
			return &m->items[k];
	return NULL;
}

static const struct alarm_item *latch_known(const struct alarm_machine *m,
                                            const struct alarm_item *i)
{
	for (uint32_t k = 0; k < m->count; k++)
		if (m->items[k].device == i->device && m->items[k].latch_cycle == m->cycle &&
		    same(m->items[k].strings.latch, i->strings.latch))
			return &m->items[k];
	return NULL;
}

static bool set_known(const struct alarm_machine *m, const struct alarm_item *i)
{
	for (uint32_t k = 0; k < m->count; k++)
		if (m->items[k].device == i->device && m->items[k].set_cycle == m->cycle &&
		    same(m->items[k].strings.set, i->strings.set) &&
		    same(m->items[k].strings.set_value, i->strings.set_value))
			return true;
	return false;
}

static bool por_reset_known(const struct alarm_machine *m, const struct alarm_item *i)
{
	for (uint32_t k = 0; k < m->count; k++)
		if (m->items[k].device == i->device && m->items[k].por_reset_cycle == m->cycle &&
		    same(m->items[k].strings.por, i->strings.por))
			return true;
	return false;
}

static bool init_known(const struct alarm_machine *m, const struct alarm_item *i)
{
	for (uint32_t k = 0; k < m->count; k++)
		if (m->items[k].device == i->device && m->items[k].init_cycle == m->cycle)
			return true;
	return false;
}

static bool reset_known(const struct alarm_machine *m, const struct alarm_item *i)
{
	for (uint32_t k = 0; k < m->count; k++)
		if (m->items[k].device == i->device && m->items[k].reset_cycle == m->cycle &&
		    same(m->items[k].strings.reset, i->strings.reset) &&
		    same(m->items[k].strings.reset_value, i->strings.reset_value))
			return true;
	return false;
}

/* The next item of the device whose latch was not read in this cycle, -1: none. */
static int64_t to_collect(const struct alarm_machine *m, const struct alarm_item *i)
{
	for (uint32_t k = 0; k < m->count; k++) {
		const struct alarm_item *other = &m->items[k];

		if (other != i && other->device == i->device && other->strings.latch &&
		    *other->strings.latch && !same(other->strings.latch, i->strings.latch) &&
		    other->collect_cycle != m->cycle && !latch_known(m, other))
			return k;
	}
	return -1;
}

static uint32_t defined(const char *name, const char *value)
{
	if (!name || !value)
		return FACT_ND;
	return *name && *value ? 0 : FACT_EMPTY;
}

static uint32_t sensed_facts(struct engine *e, const struct alarm_item *i)
{
	if (!i->strings.has_sensed || !signal_reads(signal_of(e, i)))
		return FACT_EMPTY;
	return 0;
}

/* The next output below the device that gets its InitValue, -1: none. */
static int64_t next_init(struct engine *e, struct alarm_machine *m)
{
	const struct device *d = &e->table.devices[current(m)->device];

	for (uint32_t k = 0; k < d->count; k++) {
		uint32_t row = e->table.device_rows[d->first + k];
		const struct signal *s = &e->table.signals[row];

		if ((int64_t)row > m->init_position && s->item->output && s->item->has_init &&
		    signal_writes(s) && s->lane == e->table.signals[current(m)->row].lane)
			return row;
	}
	return -1;
}

/* --- Facts of the states that need no answer ------------------------------------------------- */

static uint32_t process_facts(struct alarm_machine *m, struct engine *e)
{
	if (m->in_a_row >= e->config->max_cons_alarms)
		return FACT_MAX_CONS;
	while (++m->position < (int64_t)m->count)
		if (m->items[m->position].listed) {
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
	bool pending = lane->inputs.count || lane->outputs.count || lane->writes_in_work ||
	               lane->lent > (m->in_work ? 1u : 0u);

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
	const struct alarm_item *i = current(m), *known;

	switch (m->state) {
	case ALARM_PROCESS:
		return process_facts(m, e);
	case ALARM_BYPASS:
		return bypass_facts(m, lane, now_ns);
	case ALARM_POR_READ:
		known = por_known(m, i);
		return defined(i->strings.por, i->strings.por) | (known ? FACT_KNOWN : 0) |
		       (known && known->por_set ? FACT_NON_ZERO : 0);
	case ALARM_SET:
		return defined(i->strings.set, i->strings.set_value) |
		       (set_known(m, i) ? FACT_KNOWN : 0);
	case ALARM_POR_RESET:
		return defined(i->strings.por, i->strings.por) |
		       (por_reset_known(m, i) ? FACT_KNOWN : 0);
	case ALARM_LATCH:
		known = latch_known(m, i);
		return defined(i->strings.latch, i->strings.latch) | (known ? FACT_KNOWN : 0) |
		       (known && known->latch_set ? FACT_NON_ZERO : 0);
	case ALARM_SENSED:
	case SENSED:
		return sensed_facts(e, i);
	case ALARM_LATCH_RESET:
		return defined(i->strings.reset, i->strings.reset_value) |
		       (reset_known(m, i) ? FACT_KNOWN : 0);
	case ALARM_SET_WAIT: /* entered from ALARM_INIT_WRITE_WAIT: look for the next output */
		return next_init(e, m) >= 0 ? 0 : FACT_DONE;
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

/* --- Requests -------------------------------------------------------------------------------- */

static void ask(struct alarm_request *r, enum bus_op op, const char *before,
                const struct alarm_item *i, const char *property, const char *data)
{
	r->op = op;
	r->row = i->row;
	snprintf(r->path, sizeof(r->path), "%s%s/%s", before, i->strings.path, property);
	r->len = (uint32_t)snprintf(r->data, sizeof(r->data), "%s", data);
}

static void ask_init(struct engine *e, struct alarm_machine *m, struct alarm_request *r)
{
	int64_t row = next_init(e, m);
	const struct config_item *item = e->table.signals[row].item;

	r->op = BUS_WRITE;
	r->row = (uint32_t)row;
	snprintf(r->path, sizeof(r->path), "%s", item->path);
	if (item->type == OWS_STRING)
		r->len = (uint32_t)snprintf(r->data, sizeof(r->data), "%s", item->init_text);
	else
		r->len = (uint32_t)value_to_text(item->type, item->init_value, r->data);
}

/* The item whose SetAlarm is to be compared with the chip, if any is left. */
static bool ask_arm(struct alarm_machine *m, struct alarm_request *r)
{
	const struct alarm_strings *s;

	for (uint32_t k = 0; m->arming < 0 && k < m->count; k++)
		if (m->items[k].to_arm)
			m->arming = k;
	if (m->arming < 0)
		return false;
	s = &m->items[m->arming].strings;
	ask(r, m->arm_writes ? BUS_WRITE : BUS_READ, "", &m->items[m->arming], s->set,
	    m->arm_writes ? s->set_value : "");
	return true;
}

static bool ask_in_state(struct alarm_machine *m, struct lane *lane, struct alarm_request *r,
                         int64_t now_ns)
{
	struct alarm_item *i = current(m);

	if (m->collecting >= 0) {
		i = &m->items[m->collecting];
		ask(r, BUS_READ, "", i, i->strings.latch, "");
		return true;
	}
	switch (m->state) {
	case INIT:
		m->position = -1;
		if (ask_arm(m, r))
			return true;
		if (now_ns < m->list_ns)
			return false;
		r->op = BUS_DIR;
		r->row = TABLE_NO_ROW;
		memcpy(r->path, m->list_path, sizeof(m->list_path));
		return true;
	case ALARM_POR_READ:
		ask(r, BUS_READ, "", i, i->strings.por, "");
		return true;
	case ALARM_SET:
		ask(r, BUS_WRITE, "", i, i->strings.set, i->strings.set_value);
		return true;
	case ALARM_SET_WAIT:
		ask_init(lane->engine, m, r);
		return true;
	case ALARM_POR_RESET:
		ask(r, BUS_WRITE, "", i, i->strings.por, "0");
		return true;
	case ALARM_LATCH:
		ask(r, BUS_READ, "", i, i->strings.latch, "");
		return true;
	case ALARM_SENSED:
		ask(r, BUS_READ, "/alarm", i, i->strings.sensed, "");
		return true;
	case ALARM_LATCH_RESET:
		ask(r, BUS_WRITE, "/alarm", i, i->strings.reset, i->strings.reset_value);
		return true;
	case SENSED:
		ask(r, BUS_READ, "", i, i->strings.sensed, "");
		return true;
	case NOT_USED:
	case ALARM_DIR:
	case ALARM_PROCESS:
	case ALARM_POR_READ_WAIT:
	case ALARM_INIT_WRITE_WAIT:
	case ALARM_POR_RESET_WAIT:
	case ALARM_LATCH_WAIT:
	case ALARM_SENSED_WAIT:
	case ALARM_LATCH_RESET_WAIT:
	case SENSED_WAIT:
	case ALARM_BYPASS:
		break;
	}
	return false;
}

static void enter(struct alarm_machine *m, struct lane *lane, const struct alarm_row *row)
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
		uint32_t facts = m->collecting >= 0 ? 0 : facts_before(m, lane, now_ns);

		row = facts ? alarm_next(m->state, facts) : NULL;
		if (!row)
			return ask_in_state(m, lane, request, now_ns);
		if (m->state == ALARM_LATCH && facts & FACT_KNOWN) {
			/* the value that another item of the device has read */
			struct alarm_item *i = current(m);
			const struct alarm_item *known = latch_known(m, i);

			i->latch_set = known->latch_set;
			memcpy(i->latch_text, known->latch_text, sizeof(i->latch_text));
			if (i->latch_set)
				engine_alarm_raised(lane->engine, lane, i, now_ns);
		}
		enter(m, lane, row);
	}
	return false;
}

void alarm_started(struct alarm_machine *m, struct lane *lane, int64_t now_ns)
{
	uint32_t facts = FACT_STARTED;

	m->in_work = true;
	if (m->collecting >= 0 || m->arming >= 0)
		return;
	if (m->state == INIT) {
		m->list_ns = now_ns + lane->engine->config->alarm_period_ns;
	} else if (m->state == ALARM_SET_WAIT) {
		m->init_position = next_init(lane->engine, m);
		facts = FACT_DONE | FACT_INIT_OUTPUT;
	} else if (m->state == ALARM_SET) {
		m->init_position = -1;
	}
	enter(m, lane, alarm_next(m->state, facts));
}

/* --- Answers --------------------------------------------------------------------------------- */

/* 1, 0, or -EILSEQ: blanks trimmed; a list is non-zero if one entry is. */
static int non_zero(const char *text, size_t len)
{
	static const char *const yes[] = { "yes", "on" }, *const no[] = { "no", "off" };
	bool any = false;
	char entry[32];

	while (true) {
		const char *comma = memchr(text, ',', len);
		size_t n = comma ? (size_t)(comma - text) : len, begin = 0, end = n;
		int64_t value;
		uint8_t quality;
		bool word = false;

		while (begin < end && text[begin] == ' ')
			begin++;
		while (end > begin && text[end - 1] == ' ')
			end--;
		if (begin == end || end - begin >= sizeof(entry))
			return -EILSEQ;
		memcpy(entry, text + begin, end - begin);
		entry[end - begin] = '\0';
		for (int k = 0; k < 2; k++) {
			word |= strcmp(entry, yes[k]) == 0 || strcmp(entry, no[k]) == 0;
			any |= strcmp(entry, yes[k]) == 0;
		}
		if (!word) {
			if (value_from_text(OWS_DOUBLE, entry, strlen(entry), &value, &quality))
				return -EILSEQ;
			any |= value_number(OWS_DOUBLE, value) != 0;
		}
		if (!comma)
			return any;
		len -= n + 1;
		text = comma + 1;
	}
}

static void trim_copy(char *to, size_t size, const char *text, size_t len)
{
	while (len && *text == ' ') {
		text++;
		len--;
	}
	snprintf(to, size, "%.*s", (int)len, text);
}

static void mark_listed(struct alarm_machine *m, struct lane *lane, const char *entry, size_t len)
{
	struct engine *e = lane->engine;
	struct path path;
	bool ours = false;

	if (path_split(entry, len, &path) || !path.device.len)
		return;
	for (uint32_t k = 0; k < m->count; k++) {
		const struct device *d = &e->table.devices[m->items[k].device];
		struct path own;

		if (path.has_rom && d->has_rom) {
			if (memcmp(path.rom, d->rom, sizeof(d->rom)))
				continue;
		} else {
			const char *text = m->items[k].strings.path;

			if (path_split(text, strlen(text), &own) ||
			    !path_same_device(&path, &own))
				continue;
		}
		m->items[k].listed = ours = true;
	}
	if (ours || !path.has_rom)
		return;
	for (unsigned k = 0; k < m->strangers; k++)
		if (memcmp(m->stranger[k], path.rom, 8) == 0)
			return;
	if (m->strangers == sizeof(m->stranger) / sizeof(m->stranger[0]))
		return;
	memcpy(m->stranger[m->strangers++], path.rom, 8);
	log_info(e->log, "%s: %.*s is in alarm and has no alarm item", lane->port->target, (int)len,
	         entry);
}

static void take_list(struct alarm_machine *m, struct lane *lane, const char *list, size_t len,
                      int64_t now_ns)
{
	m->cycle++;
	lane->counters.alarm_lists++;
	m->wait_ns = 0;
	for (uint32_t k = 0; k < m->count; k++)
		m->items[k].listed = false;
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
		if (!m->items[k].listed && m->items[k].stands)
			engine_alarm_ended(lane->engine, &m->items[k], now_ns);
}

static void list_failed(struct alarm_machine *m, struct lane *lane, int err, int64_t now_ns)
{
	struct engine *e = lane->engine;

	if (err == -EOPNOTSUPP) {
		log_notice(e->log, "%s: no alarm search: alarm items are read as ordinary inputs",
		           lane->port->target);
		m->polls = true;
		m->state = NOT_USED;
		engine_alarm_polls(e, m);
		return;
	}
	m->wait_ns = m->wait_ns ? m->wait_ns * 2 : e->config->alarm_period_ns;
	if (m->wait_ns > LIST_WAIT_MAX)
		m->wait_ns = LIST_WAIT_MAX;
	m->list_ns = now_ns + m->wait_ns;
	m->position = -1;
}

static bool as_set(const char *text, size_t len, const char *value)
{
	char is[ALARM_TEXT];
	double a, b;
	char *end_a, *end_b;

	trim_copy(is, sizeof(is), text, len);
	a = strtod(is, &end_a);
	b = strtod(value, &end_b);
	if (*is && *value && !*end_a && !*end_b)
		return a == b;
	return strcmp(is, value) == 0;
}

static void armed(struct alarm_machine *m, const struct bus_answer *answer, const char *data)
{
	struct alarm_item *i = &m->items[m->arming];

	if (failure_of(answer->err) == FAILURE_TARGET) {
		m->arming = -1;
		m->arm_writes = false;
		return;
	}
	if (!answer->err && !m->arm_writes && !as_set(data, answer->len, i->strings.set_value)) {
		m->arm_writes = true;
		return;
	}
	i->to_arm = false;
	m->arming = -1;
	m->arm_writes = false;
}

static int take_latch(struct alarm_machine *m, struct alarm_item *i,
                      const struct bus_answer *answer, const char *data)
{
	int set = answer->err ? answer->err : non_zero(data, answer->len);

	if (set < 0)
		return set;
	i->latch_cycle = m->cycle;
	i->latch_set = set;
	trim_copy(i->latch_text, sizeof(i->latch_text), data, answer->len);
	return 0;
}

/* What the answer means to the state; side effects on table and journal included. */
static uint32_t facts_after(struct alarm_machine *m, struct lane *lane, const struct slot *slot,
                            const struct bus_answer *answer, int64_t now_ns)
{
	struct engine *e = lane->engine;
	struct alarm_item *i = current(m);
	const char *data = m->state == ALARM_DIR ? m->list : (const char *)slot->data;
	int err = answer->err, set;

	switch (m->state) {
	case ALARM_DIR:
		if (!err)
			take_list(m, lane, data, answer->len, now_ns);
		else
			list_failed(m, lane, err, now_ns);
		break;
	case ALARM_POR_READ_WAIT:
		set = err ? err : non_zero(data, answer->len);
		err = set < 0 ? set : 0;
		if (err)
			break;
		i->por_cycle = m->cycle;
		i->por_set = set;
		if (set)
			engine_power_on_reset(e, lane, i, now_ns);
		return FACT_DONE | (set ? FACT_NON_ZERO : 0);
	case ALARM_SET_WAIT:
		if (!err) {
			i->set_cycle = m->cycle;
			if (init_known(m, i) || next_init(e, m) < 0)
				return FACT_DONE;
			i->init_cycle = m->cycle;
			return 0; /* the first output is asked for from here */
		}
		break;
	case ALARM_INIT_WRITE_WAIT:
		engine_write_done(e, lane, slot, answer, now_ns);
		return (err ? FACT_FAILED : FACT_DONE) | (m->init_position >= 0 ? FACT_INIT_POS : 0);
	case ALARM_POR_RESET_WAIT:
		if (!err)
			i->por_reset_cycle = m->cycle;
		break;
	case ALARM_LATCH_WAIT:
		err = take_latch(m, i, answer, data);
		if (err)
			break;
		if (i->latch_set)
			engine_alarm_raised(e, lane, i, now_ns);
		return FACT_DONE | (i->latch_set ? FACT_NON_ZERO : 0);
	case ALARM_SENSED_WAIT:
	case SENSED_WAIT:
		err = engine_alarm_value(e, lane, i, slot, answer, now_ns);
		if (err && m->state == SENSED_WAIT)
			engine_read_at(e, signal_of(e, i), e->period + 1);
		return err ? FACT_FAILED : FACT_DONE;
	case ALARM_LATCH_RESET_WAIT:
		if (!err) {
			i->reset_cycle = m->cycle;
			engine_alarm_ended(e, i, now_ns);
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
	if (err && i)
		engine_alarm_failed(e, lane, i, err);
	return err ? FACT_FAILED : FACT_DONE;
}

/*
 * Before the first reset of a device with several alarm items, every latch of it is read: the reset
 * of one would clear the others'.
 */
static bool collect(struct alarm_machine *m)
{
	const struct alarm_item *i = current(m);

	if (!i || (m->state != ALARM_POR_READ_WAIT && m->state != ALARM_LATCH_WAIT))
		return false;
	m->collecting = to_collect(m, i);
	return m->collecting >= 0;
}

void alarm_answered(struct alarm_machine *m, struct lane *lane, const struct slot *slot,
                    const struct bus_answer *answer, int64_t now_ns)
{
	uint32_t facts;

	m->in_work = false;
	if (m->arming >= 0) {
		armed(m, answer, (const char *)slot->data);
		return;
	}
	if (failure_of(answer->err) == FAILURE_TARGET || answer->err == -ECANCELED ||
	    answer->err == -ETIME) {
		alarm_restart(m);
		return;
	}
	if (m->collecting >= 0) {
		struct alarm_item *other = &m->items[m->collecting];

		/* what cannot be read now is asked for again by its own item */
		other->collect_cycle = m->cycle;
		take_latch(m, other, answer, (const char *)slot->data);
		m->collecting = to_collect(m, current(m));
		if (m->collecting < 0)
			enter(m, lane, alarm_next(m->state, m->held));
		return;
	}
	facts = facts_after(m, lane, slot, answer, now_ns);
	if (m->state == NOT_USED || !facts)
		return;
	m->held = facts;
	if (!(facts & FACT_DONE) || !collect(m))
		enter(m, lane, alarm_next(m->state, facts));
}

void alarm_passed(struct alarm_machine *m)
{
	m->passed = true;
}

bool alarm_holds(const struct alarm_machine *m)
{
	return m->in_work ||
	       (m->state != NOT_USED && m->state != INIT && m->state != ALARM_BYPASS);
}

bool alarm_serves(const struct alarm_machine *m)
{
	return m->count && !m->polls;
}

int64_t alarm_wake(const struct alarm_machine *m)
{
	if (m->in_work)
		return INT64_MAX;
	return m->state == INIT ? m->list_ns : m->state == ALARM_BYPASS ? m->bypass_ns : INT64_MAX;
}

void alarm_restart(struct alarm_machine *m)
{
	if (m->state == NOT_USED)
		return;
	m->state = INIT;
	m->position = m->init_position = m->arming = m->collecting = -1;
	m->arm_writes = false;
	m->in_work = false;
	m->in_a_row = 0;
}

void alarm_rearm(struct alarm_machine *m, uint32_t device)
{
	for (uint32_t k = 0; k < m->count; k++) {
		const struct alarm_strings *s = &m->items[k].strings;

		if (m->items[k].device == device && s->set && *s->set && s->set_value &&
		    *s->set_value)
			m->items[k].to_arm = true;
	}
}
