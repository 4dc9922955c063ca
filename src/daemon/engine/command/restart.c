/* SPDX-License-Identifier: MIT */
/*
 * Restarts of devices that no alarm item watches: a power-on flag that was clear and is set proves
 * one, and then the outputs of the device are written again. A flag that was never cleared says
 * nothing, and owsd does not clear it.
 */
#include <stdio.h>
#include <string.h>

#include "hal/owfs/path.h"
#include "src/daemon/engine/alarm/alarm_effect.h"
#include "src/daemon/engine/alarm/alarm_item.h"
#include "src/daemon/engine/alarm/alarm_text.h"
#include "src/daemon/engine/command/restart.h"
#include "src/daemon/engine/due.h"
#include "src/daemon/engine/retry.h"
#include "src/daemon/engine/slots.h"
#include "src/daemon/engine/state.h"

static bool is_watched(const struct alarm_machine *m, uint32_t device)
{
	for (uint32_t k = 0; k < m->count; k++)
		if (m->items[k]->device == device && m->items[k]->strings.por &&
		    *m->items[k]->strings.por)
			return true;
	return false;
}

void engine_restart_look(struct lane *lane, const struct signal *s, bool agrees)
{
	const struct device *d;

	if (!s->item->has_por || s->device == TABLE_NO_DEVICE)
		return;
	d = &lane->engine->table.devices[s->device];
	if (agrees && lane->engine->time.now_ns < d->por_ns)
		return;
	if (d->por == (agrees ? POR_UNKNOWN : POR_CLEAR) && !is_watched(&lane->alarm, s->device))
		due_set_add(&lane->restarts, s->device);
}

bool engine_restart_ask(struct lane *lane, struct slot *slot)
{
	const struct table *table = &lane->engine->table;
	int64_t device = due_set_next(&lane->restarts);
	const struct signal *s;
	struct path path;

	if (device < 0)
		return false;
	s = &table->signals[table->device_rows[table->devices[device].first]];
	if (s->lane != lane->index || path_split(s->item->path, strlen(s->item->path), &path)) {
		due_set_take(&lane->restarts, (uint32_t)device);
		return false;
	}
	snprintf(slot->path, sizeof(slot->path), "%.*s/por",
	         (int)(path.device.text + path.device.len - s->item->path), s->item->path);
	slot->purpose = FOR_RESTART;
	slot->row = (uint32_t)device;
	slot->req = (struct bus_req){.op = BUS_READ,
	                             .prio = BUS_INPUT,
	                             .fresh = true,
	                             .path = slot->path,
	                             .len = sizeof(slot->data)};
	if (!slot_lend(lane, slot))
		return false;
	due_set_take(&lane->restarts, (uint32_t)device);
	return true;
}

void engine_restart_done(struct lane *lane, const struct slot *slot,
                         const struct bus_answer *answer)
{
	struct device *d = &lane->engine->table.devices[slot->row];
	bool was_clear = d->por == POR_CLEAR;
	int set = answer->err ? answer->err : alarm_non_zero((const char *)slot->data, answer->len);

	if (set < 0) {
		d->por_ns = lane->engine->time.now_ns + RETRY_MAX_NS;
		return;
	}
	d->por = set ? POR_SET : POR_CLEAR;
	for (uint32_t k = 0; set && was_clear && k < d->count; k++) {
		const struct table *table = &lane->engine->table;
		const struct signal *s = &table->signals[table->device_rows[d->first + k]];

		if (s->lane == lane->index && s->item->output) {
			engine_power_on_reset(lane, d, s, true);
			return;
		}
	}
}
