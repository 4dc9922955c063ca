/* SPDX-License-Identifier: MIT */
/* The list of devices in alarm, /alarm: which alarm items it names, and a bus that has none. */
#include <errno.h>
#include <string.h>

#include "hal/base/time.h"
#include "hal/owfs/path.h"
#include "src/daemon/engine/alarm/alarm_effect.h"
#include "src/daemon/engine/alarm/alarm_list.h"
#include "src/daemon/engine/alarm/alarm_refused.h"
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

void alarm_take_list(struct alarm_machine *m, struct lane *lane, const char *list, size_t len)
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

void alarm_list_failed(struct alarm_machine *m, struct lane *lane, int err)
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
