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

static bool same_text(const char *a, const char *b)
{
	return a && b && strcmp(a, b) == 0;
}

static bool same_deed(const struct alarm_strings *a, const struct alarm_strings *b,
                      enum alarm_deed deed)
{
	switch (deed) {
	case ALARM_POR_WAS_READ:
	case ALARM_POR_WAS_RESET:
		return same_text(a->por, b->por);
	case ALARM_LATCH_WAS_READ:
		return same_text(a->latch, b->latch);
	case ALARM_LATCH_WAS_RESET:
		return same_text(a->reset, b->reset) && same_text(a->reset_value, b->reset_value);
	case ALARM_WAS_SET:
		return same_text(a->set, b->set) && same_text(a->set_value, b->set_value);
	case ALARM_INIT_WAS_WRITTEN:
	case ALARM_WAS_COLLECTED:
	case ALARM_DEEDS:
		break;
	}
	return true;
}

const struct alarm_item *alarm_known(const struct alarm_machine *m, const struct alarm_item *i,
                                     enum alarm_deed deed)
{
	for (uint32_t k = 0; k < m->count; k++)
		if (m->items[k]->device == i->device &&
		    m->items[k]->cycle_of[deed] == m->list.cycle &&
		    same_deed(&m->items[k]->strings, &i->strings, deed))
			return m->items[k];
	return NULL;
}

/* The next item of the device whose latch was not read in this cycle, -1: none. */
int64_t alarm_to_collect(const struct alarm_machine *m, const struct alarm_item *i)
{
	for (uint32_t k = 0; k < m->count; k++) {
		const struct alarm_item *other = m->items[k];

		if (other != i && other->device == i->device && other->strings.latch &&
		    *other->strings.latch && !same_text(other->strings.latch, i->strings.latch) &&
		    other->cycle_of[ALARM_WAS_COLLECTED] != m->list.cycle &&
		    !alarm_known(m, other, ALARM_LATCH_WAS_READ))
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
