/* SPDX-License-Identifier: MIT */
/* What the alarm machine has read and written in the present cycle, looked up by device. */
#include <string.h>

#include "src/engine/alarm_known.h"
#include "src/engine/state.h"

struct signal *alarm_signal(struct engine *e, const struct alarm_item *item)
{
	return &e->table.signals[item->row];
}

struct alarm_item *alarm_current(struct alarm_machine *m)
{
	return m->position < 0 ? NULL : m->items[m->position];
}

/* The same device in the same cycle: what was done there need not be done again. */
static bool same_text(const char *a, const char *b)
{
	return a && b && strcmp(a, b) == 0;
}

const struct alarm_item *alarm_por_known(const struct alarm_machine *m, const struct alarm_item *i)
{
	for (uint32_t k = 0; k < m->count; k++)
		if (m->items[k]->device == i->device && m->items[k]->por_cycle == m->list.cycle &&
		    same_text(m->items[k]->strings.por, i->strings.por))
			return m->items[k];
	return NULL;
}

const struct alarm_item *alarm_latch_known(const struct alarm_machine *m,
                                           const struct alarm_item *i)
{
	for (uint32_t k = 0; k < m->count; k++)
		if (m->items[k]->device == i->device && m->items[k]->latch_cycle == m->list.cycle &&
		    same_text(m->items[k]->strings.latch, i->strings.latch))
			return m->items[k];
	return NULL;
}

bool alarm_set_known(const struct alarm_machine *m, const struct alarm_item *i)
{
	for (uint32_t k = 0; k < m->count; k++)
		if (m->items[k]->device == i->device && m->items[k]->set_cycle == m->list.cycle &&
		    same_text(m->items[k]->strings.set, i->strings.set) &&
		    same_text(m->items[k]->strings.set_value, i->strings.set_value))
			return true;
	return false;
}

bool alarm_por_reset_known(const struct alarm_machine *m, const struct alarm_item *i)
{
	for (uint32_t k = 0; k < m->count; k++)
		if (m->items[k]->device == i->device &&
		    m->items[k]->por_reset_cycle == m->list.cycle &&
		    same_text(m->items[k]->strings.por, i->strings.por))
			return true;
	return false;
}

bool alarm_init_known(const struct alarm_machine *m, const struct alarm_item *i)
{
	for (uint32_t k = 0; k < m->count; k++)
		if (m->items[k]->device == i->device && m->items[k]->init_cycle == m->list.cycle)
			return true;
	return false;
}

bool alarm_reset_known(const struct alarm_machine *m, const struct alarm_item *i)
{
	for (uint32_t k = 0; k < m->count; k++)
		if (m->items[k]->device == i->device && m->items[k]->reset_cycle == m->list.cycle &&
		    same_text(m->items[k]->strings.reset, i->strings.reset) &&
		    same_text(m->items[k]->strings.reset_value, i->strings.reset_value))
			return true;
	return false;
}

/* The next item of the device whose latch was not read in this cycle, -1: none. */
int64_t alarm_to_collect(const struct alarm_machine *m, const struct alarm_item *i)
{
	for (uint32_t k = 0; k < m->count; k++) {
		const struct alarm_item *other = m->items[k];

		if (other != i && other->device == i->device && other->strings.latch &&
		    *other->strings.latch && !same_text(other->strings.latch, i->strings.latch) &&
		    other->collect_cycle != m->list.cycle && !alarm_latch_known(m, other))
			return k;
	}
	return -1;
}

int64_t alarm_next_init(struct engine *e, struct alarm_machine *m)
{
	const struct alarm_item *current = alarm_current(m);
	const struct device *d;

	if (!current)
		return -1;
	d = &e->table.devices[current->device];
	for (uint32_t k = 0; k < d->count; k++) {
		uint32_t row = e->table.device_rows[d->first + k];
		const struct signal *s = &e->table.signals[row];

		if ((int64_t)row > m->init_position && s->item->output && s->item->has_init &&
		    !s->item->starts_last && !s->command.confirmed && signal_writes(s) &&
		    !s->doubts && s->lane == e->table.signals[current->row].lane)
			return row;
	}
	return -1;
}
