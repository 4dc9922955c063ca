/* SPDX-License-Identifier: MIT */
/* What the alarm machine changes in the table. */
#include "private.h"

#include <string.h>

void engine_alarm_raised(struct engine *e, struct lane *lane, struct alarm_item *item,
                         int64_t now_ns)
{
	struct signal *s = &e->table.signals[item->row];

	(void)now_ns;
	if (item->stands)
		return;
	item->stands = true;
	s->attrs.alarms++;
	lane->counters.alarms++;
	log_info(e->log, "%s: alarm, %s is %s", s->item->name, item->strings.latch,
	         item->latch_text);
	engine_publish(e, s);
}

void engine_alarm_ended(struct engine *e, struct alarm_item *item)
{
	item->stands = false;
	engine_publish(e, &e->table.signals[item->row]);
}

int engine_alarm_value(struct engine *e, struct lane *lane, struct alarm_item *item,
                       const struct slot *slot, const struct bus_answer *answer, int64_t now_ns)
{
	struct signal *s = &e->table.signals[item->row];
	int64_t wait_ns;
	int err;

	if (!signal_reads(s))
		return 0;
	err = engine_take_reading(e, lane, s, slot, answer, now_ns, &wait_ns);
	engine_publish(e, s);
	return err;
}

void engine_power_on_reset(struct engine *e, struct lane *lane, const struct alarm_item *item)
{
	const struct device *d = &e->table.devices[item->device];

	lane->counters.power_on_resets++;
	log_notice(e->log, "%s: the device has restarted", item->strings.path);
	for (uint32_t k = 0; k < d->count; k++) {
		struct signal *s = &e->table.signals[e->table.device_rows[d->first + k]];

		if (s->lane != lane->index)
			continue;
		s->confirmed = false;
		engine_write_check(e, s);
	}
}

void engine_alarm_polls(struct engine *e, struct alarm_machine *m)
{
	for (uint32_t k = 0; k < m->count; k++) {
		struct signal *s = &e->table.signals[m->items[k].row];

		engine_read_at(e, s, e->period + 1);
		engine_publish(e, s);
	}
}
