/* SPDX-License-Identifier: MIT */
/*
 * Presence belongs to the device: whatever has shown that it is lost, or is there again, comes here
 * and counts for all its signals.
 */
#include <errno.h>

#include "src/daemon/engine/alarm/alarm_arm.h"
#include "src/daemon/engine/presence.h"
#include "src/daemon/engine/publish.h"
#include "src/daemon/engine/retry.h"
#include "src/daemon/engine/routing/known.h"
#include "src/daemon/engine/schedule.h"
#include "src/ground/text/log.h"

/* Nothing else would show it of an output that is not read. */
static void lose_output(struct engine *e, struct signal *s)
{
	if (!s->item->output || s->sample.quality == OWS_Q_INITIAL ||
	    s->sample.quality == OWS_Q_NO_DEVICE)
		return;
	signal_hold(s); /* another target may have the device */
	s->sample.quality = OWS_Q_NO_DEVICE;
	s->sample.err = -ENODEV;
	log_warning(e->log, "%s (%s): %s", s->item->name, s->item->path,
	            ows_quality_text(OWS_Q_NO_DEVICE));
	engine_publish(e, s);
}

void engine_device_lost(struct lane *lane, uint32_t index)
{
	struct engine *e = lane->engine;
	struct device *device = &e->table.devices[index];
	bool known = device->absent;

	device->absent = true;
	engine_presence(e, lane, index, ROUTE_ABSENT);
	for (uint32_t i = 0; i < device->count; i++) {
		struct signal *s = &e->table.signals[e->table.device_rows[device->first + i]];

		if (s->lane != lane->index)
			continue;
		if (!signal_is_read(s))
			lose_output(e, s);
		else if (!known)
			engine_read_now(e, s);
	}
}

void engine_device_back(struct lane *lane, struct device *device)
{
	struct engine *e = lane->engine;

	device->absent = false;
	device->por = POR_UNKNOWN;
	engine_watch_anew(lane, (uint32_t)(device - e->table.devices));
	lane->counters.device_returns++;
	for (uint32_t i = 0; i < device->count; i++) {
		struct signal *s = &e->table.signals[e->table.device_rows[device->first + i]];

		if (s->lane != lane->index)
			continue;
		retry_clear(&s->read.retry);
		retry_clear(&s->command.retry);
		due_wheel_cancel(&e->wheel, engine_row(s) * 2 + 1);
		alarm_rearm(&lane->alarm, e, s->device);
		signal_forget_written(s);
		engine_read_now(e, s);
		engine_write_check(e, s);
		/* neither read nor written: what it has is not known */
		if (s->sample.quality == OWS_Q_NO_DEVICE && !signal_is_read(s) &&
		    !signal_changed(s)) {
			signal_lapse(s);
			engine_publish(e, s);
		}
	}
}
