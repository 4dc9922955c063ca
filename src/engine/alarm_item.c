/* SPDX-License-Identifier: MIT */
/* What an alarm item says, and the making of a lane's machine. */
#include "alarm.h"

#include "hal/path.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

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

void alarm_split(const struct config_item *item, struct alarm_strings *s)
{
	struct path path;

	*s = (struct alarm_strings){ .has_sensed = false };
	if (!path_split(item->path, strlen(item->path), &path) && path.device.len) {
		int len = (int)(path.device.text + path.device.len - item->path);

		snprintf(s->path, sizeof(s->path), "%.*s", len, item->path);
		snprintf(s->sensed, sizeof(s->sensed), "%.*s", (int)path.property.len,
		         path.property.len ? path.property.text : "");
		s->has_sensed = path.property.len > 0;
	}
	s->por = item->por_alarm;
	s->latch = item->latch_alarm;
	split_pair(item->set_alarm, s->set_text, &s->set, &s->set_value);
	split_pair(item->reset_latch, s->reset_text, &s->reset, &s->reset_value);
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

/* A thermometer with its factory limits is always in alarm: the search need not go there. */
static void name_list(struct alarm_machine *m, bool searches)
{
	size_t used = (size_t)snprintf(m->list_path, sizeof(m->list_path), "/alarm");

	if (!searches || m->family_count > sizeof(m->families))
		return;
	for (unsigned i = 0; i < m->family_count; i++)
		used += (size_t)snprintf(m->list_path + used, sizeof(m->list_path) - used, "%c%02X",
		                         i ? ',' : '/', m->families[i]);
}

int alarm_init(struct alarm_machine *m, const struct table *table, unsigned lane, bool searches,
               int64_t now_ns)
{
	uint32_t count = 0;

	*m = (struct alarm_machine){ .state = NOT_USED, .position = -1, .init_position = -1,
		                     .arming = -1, .collecting = -1, .list_ns = now_ns };
	for (uint32_t row = 0; row < table->count; row++)
		count += table->signals[row].lane == lane && table->signals[row].item->alarm &&
		         table->signals[row].device != TABLE_NO_DEVICE;
	if (!count)
		return 0;
	m->items = calloc(count, sizeof(*m->items));
	m->list = calloc(1, ALARM_LIST);
	if (!m->items || !m->list) {
		alarm_free(m);
		return -ENOMEM;
	}
	for (uint32_t row = 0; row < table->count; row++) {
		const struct signal *s = &table->signals[row];
		struct alarm_item *item = &m->items[m->count];

		if (s->lane != lane || !s->item->alarm || s->device == TABLE_NO_DEVICE)
			continue;
		item->row = row;
		item->device = s->device;
		alarm_split(s->item, &item->strings);
		item->to_arm = item->strings.set && *item->strings.set &&
		               item->strings.set_value && *item->strings.set_value;
		add_family(m, table, s->device);
		m->count++;
	}
	name_list(m, searches);
	m->state = alarm_next(NOT_USED, FACT_ITEMS)->next;
	return 0;
}

void alarm_free(struct alarm_machine *m)
{
	free(m->items);
	free(m->list);
	m->items = NULL;
	m->list = NULL;
	m->count = 0;
}
