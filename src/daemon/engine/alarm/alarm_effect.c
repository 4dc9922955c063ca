/* SPDX-License-Identifier: MIT */
/* What alarms and restarts of devices change in the table, in the journal and in the log. */
#include <string.h>

#include "src/daemon/engine/alarm/alarm_effect.h"
#include "src/daemon/engine/alarm/alarm_text.h"
#include "src/daemon/engine/publish.h"
#include "src/daemon/engine/schedule.h"
#include "src/ground/text/log.h"
#include "src/memory/shm/entries.h"

struct signal *alarm_signal(struct engine *e, const struct alarm_item *item)
{
	return &e->table.signals[item->row];
}

struct alarm_item *alarm_current(struct alarm_machine *m)
{
	return m->position < 0 ? NULL : m->items[m->position];
}

static struct ows_journal_entry alarm_entry(const struct engine *e, const struct signal *s,
                                            enum ows_alarm_kind kind, enum ows_alarm_event event)
{
	struct ows_journal_entry entry = signal_entry(s, kind, event, e->time.now_ns);

	if (s->sample.count && !signal_is_string(s)) {
		entry.before = s->sample.value;
		entry.flags = OWS_JOURNAL_BEFORE;
	}
	return entry;
}

void engine_alarm_raised(struct engine *e, struct lane *lane, struct alarm_item *item)
{
	struct signal *s = &e->table.signals[item->row];
	uint32_t channels = alarm_channels(item->occurrence.latch_text);
	struct ows_journal_entry entry;

	if (item->occurrence.stands)
		return;
	item->occurrence.stands = true;
	s->attrs.alarms++;
	s->attrs.flags |= OWS_ATTR_ALARM_STANDS;
	lane->counters.alarms++;
	if (channels & ~item->occurrence.entered) {
		entry = alarm_entry(e, s, OWS_ALARM_DEVICE, OWS_ALARM_RAISED);
		memcpy(entry.text, item->occurrence.latch_text,
		       strnlen(item->occurrence.latch_text, sizeof(item->occurrence.latch_text)));
		item->occurrence.journal = image_alarm(e->image, &entry);
		item->occurrence.entered |= channels;
		item->occurrence.wants_after = true;
		log_notice(e->log, "%s: alarm, %s is %s", s->item->name, item->strings.latch,
		           item->occurrence.latch_text);
	}
	engine_publish(e, s);
}

void engine_alarm_rests(struct engine *e, struct alarm_item *item)
{
	struct signal *s = &e->table.signals[item->row];
	struct ows_journal_entry entry = alarm_entry(e, s, OWS_ALARM_DEVICE, OWS_ALARM_RETURNED);

	item->occurrence.stands = false;
	if (s->attrs.flags & OWS_ATTR_ALARM_STANDS) {
		s->attrs.flags &= ~(uint32_t)OWS_ATTR_ALARM_STANDS;
		engine_publish(e, s);
	}
	if (!item->occurrence.entered)
		return;
	item->occurrence.entered = 0;
	image_alarm(e->image, &entry);
	e->published = true;
}

void engine_power_on_reset(struct lane *lane, const struct device *d, const struct signal *shown,
                           bool seen)
{
	struct engine *e = lane->engine;
	struct ows_journal_entry entry = alarm_entry(e, shown, OWS_ALARM_POR, OWS_ALARM_RAISED);

	image_alarm(e->image, &entry);
	e->published = true;
	lane->counters.power_on_resets++;
	/* each board of a plant that is switched on has, and so it is no news at the start */
	log_at(e->log, seen ? LOG_LEVEL_NOTICE : LOG_LEVEL_INFO,
	       "%s (%s): the device has restarted%s", shown->item->name, shown->item->path,
	       seen ? "" : " before owsd looked at it first");
	for (uint32_t k = 0; k < d->count; k++) {
		struct signal *s = &e->table.signals[e->table.device_rows[d->first + k]];

		if (s->lane != lane->index)
			continue;
		/* after a restart before owsd's first look it got its command, and no InitValue */
		if (!seen && s->command.confirmed && s->item->output)
			s->command.forced = true;
		else
			signal_forget_written(s);
		engine_write_check(e, s);
	}
}

void engine_alarm_polled(struct engine *e, struct alarm_item *item)
{
	engine_alarm_rests(e, item);
	alarm_signal(e, item)->attrs.flags |= OWS_ATTR_ALARM_POLLED;
}

void engine_alarm_polls(struct engine *e, struct alarm_machine *m)
{
	for (uint32_t k = 0; k < m->count; k++) {
		struct signal *s = &e->table.signals[m->items[k]->row];

		engine_alarm_polled(e, m->items[k]);
		engine_read_at(e, s, e->time.period + 1);
		engine_publish(e, s);
	}
}
