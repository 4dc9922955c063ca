/* SPDX-License-Identifier: MIT */
/*
 * Alarm items are made from the configuration here; they come to the machine of a lane and leave
 * it.
 */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/chips/facts.h"
#include "hal/owfs/path.h"
#include "src/daemon/engine/alarm/alarm_item.h"

/* "name=value" at its first '='; no '=': the value is not defined. */
static void split_pair(const char *text, char *copy, const char **name, const char **value)
{
	char *equals;

	*name = *value = NULL;
	if (!text)
		return;
	snprintf(copy, ALARM_TEXT, "%s", text);
	*name = copy;
	if (!*copy) {
		*value = copy;
		return;
	}
	equals = strchr(copy, '=');
	if (equals) {
		*equals = '\0';
		*value = equals + 1;
	}
}

/* Split what the item says. */
static void alarm_split(const struct config_item *item, struct alarm_strings *s)
{
	struct path path;

	*s = (struct alarm_strings){0};
	if (!path_split(item->path, strlen(item->path), &path) && path.device.len) {
		int len = (int)(path.device.text + path.device.len - item->path);

		snprintf(s->path, sizeof(s->path), "%.*s", len, item->path);
		snprintf(s->sensed, sizeof(s->sensed), "%.*s", (int)path.property.len,
		         path.property.len ? path.property.text : "");
	}
	s->por = item->por_alarm;
	s->latch = item->latch_alarm;
	split_pair(item->set_alarm, s->set_text, &s->set, &s->set_value);
	split_pair(item->reset_latch, s->reset_text, &s->reset, &s->reset_value);
}

bool alarm_arms(const struct alarm_item *item)
{
	const struct alarm_strings *s = &item->strings;

	return s->set && *s->set && s->set_value && *s->set_value;
}

int alarm_items_init(const struct table *table, struct alarm_item **items, uint32_t *count)
{
	*items = NULL;
	*count = 0;
	for (uint32_t row = 0; row < table->count; row++)
		*count += table->signals[row].item->alarm &&
		          signal_has_device(&table->signals[row]);
	if (!*count)
		return 0;
	*items = calloc(*count, sizeof(**items));
	if (!*items)
		return -ENOMEM;
	*count = 0;
	for (uint32_t row = 0; row < table->count; row++) {
		const struct signal *s = &table->signals[row];
		struct alarm_item *item = &(*items)[*count];

		if (!s->item->alarm || !signal_has_device(s))
			continue;
		item->row = row;
		item->device = s->device;
		alarm_split(s->item, &item->strings);
		++*count;
	}
	return 0;
}

static void add_family(struct alarm_machine *m, const struct table *table, uint32_t device)
{
	const struct device *d = &table->devices[device];

	if (!d->has_rom) {
		m->family_count = sizeof(m->families) + 1; /* an alias may be any */
		return;
	}
	if (m->family_count > sizeof(m->families) ||
	    memchr(m->families, d->rom[0], m->family_count))
		return;
	if (m->family_count < sizeof(m->families))
		m->families[m->family_count] = d->rom[0];
	m->family_count++;
}

/*
 * Of a device with a latch a bus may read a part of the id, and guess the rest: which is right by
 * the latch. Here nobody looks at that.
 */
static bool wants_whole(const struct alarm_strings *strings)
{
	return strings->latch && strcmp(strings->latch, "present") == 0 &&
	       facts_latches(strings->path);
}

/* A thermometer with its factory limits is always in alarm: the search need not go there. */
void alarm_name_list(struct alarm_machine *m, const struct table *table)
{
	size_t used = (size_t)snprintf(m->list_path, sizeof(m->list_path), "/alarm");

	m->named = true;
	m->whole = false;
	m->family_count = 0;
	for (uint32_t k = 0; k < m->count; k++) {
		add_family(m, table, m->items[k]->device);
		m->whole |= wants_whole(&m->items[k]->strings);
	}
	if (!m->searches || m->family_count > sizeof(m->families))
		return;
	for (unsigned i = 0; i < m->family_count; i++)
		used += (size_t)snprintf(m->list_path + used, sizeof(m->list_path) - used, "%c%02X",
		                         i ? ',' : '/', m->families[i]);
}

int alarm_init(struct alarm_machine *m, uint32_t room, bool searches)
{
	*m = (struct alarm_machine){
		.state = NOT_USED,
		.position = -1,
		.init_position = -1,
		.searches = searches,
		.anew = true,
	};
	if (!room)
		return 0;
	m->items = calloc(room, sizeof(*m->items));
	return m->items ? 0 : -ENOMEM;
}

void alarm_free(struct alarm_machine *m)
{
	free(m->items);
	m->items = NULL;
	m->count = 0;
}

void alarm_take_item(struct alarm_machine *m, struct alarm_item *item, int64_t now_ns)
{
	uint32_t at = m->count;

	while (at > 0 && m->items[at - 1]->row > item->row)
		at--;
	memmove(&m->items[at + 1], &m->items[at], (m->count - at) * sizeof(*m->items));
	m->items[at] = item;
	m->count++;
	m->position += m->position >= (int64_t)at;
	item->listed = false;
	item->arming.wanted = alarm_arms(item);
	item->arming.cycle = m->list.cycle;
	item->asks_por = item->restart.known; /* unless it is listed there */
	retry_clear(&item->arming.retry);
	item->arming.not_before_ns = 0;
	retry_clear(&item->visit.retry); /* what is shown stays until it succeeds */
	item->visit.not_before_ns = 0;
	memset(item->cycle_of, 0, sizeof(item->cycle_of));
	m->named = false;
	if (m->state != NOT_USED || m->list.polls)
		return;
	m->state = alarm_next(NOT_USED, FACT_ITEMS)->next;
	m->list.next_ns = later_ns(m->list.next_ns, now_ns);
}

bool alarm_drop_item(struct alarm_machine *m, struct alarm_item *item)
{
	bool current, arming = item == m->arming, asked = m->in_work;
	int64_t at = 0;

	while (at < (int64_t)m->count && m->items[at] != item)
		at++;
	if (at == (int64_t)m->count)
		return false;
	current = at == m->position;
	if (arming || (m->collecting && (current || item == m->collecting))) {
		m->arming = m->collecting = NULL;
		m->arm_writes = false;
	}
	m->count--;
	memmove(&m->items[at], &m->items[at + 1], (m->count - (uint32_t)at) * sizeof(*m->items));
	/* the next alarm is the item after the one that leaves */
	m->position -= m->position >= at;
	if (current && m->state != ALARM_BYPASS)
		m->state = ALARM_PROCESS;
	if (current) {
		m->init_position = -1;
		m->proving = false;
	}
	m->named = false;
	if (!m->count)
		m->state = NOT_USED;
	if (!asked || !(arming || current || !m->count))
		return false;
	m->in_work = false;
	return true;
}

void alarm_restart(struct alarm_machine *m)
{
	if (m->state == NOT_USED)
		return;
	m->state = INIT;
	m->anew = true;
	m->position = m->init_position = -1;
	m->arming = m->collecting = NULL;
	m->arm_writes = m->proving = false;
	m->in_work = false;
	m->in_a_row = 0;
}

bool alarm_serves(const struct alarm_machine *m)
{
	return m->count && !m->list.polls;
}

void alarm_output_differs(struct alarm_machine *m, uint32_t device)
{
	for (uint32_t k = 0; k < m->count; k++)
		if (m->items[k]->device == device && m->items[k]->restart.known)
			m->items[k]->restart.differs = true;
}
