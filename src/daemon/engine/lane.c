/* SPDX-License-Identifier: MIT */
/* A lane is made and ended here; rows of the table come to it and leave it. */
#include <errno.h>

#include "src/daemon/engine/alarm/alarm_item.h"
#include "src/daemon/engine/lane.h"
#include "src/daemon/engine/slots.h"

int lane_init(struct lane *lane, struct engine *engine, const struct engine_port *port,
              unsigned index)
{
	*lane = (struct lane){.engine = engine, .port = port, .index = index};
	if (slots_init(lane) || due_set_init(&lane->inputs, engine->table.count) ||
	    due_set_init(&lane->outputs, engine->table.count) ||
	    due_set_init(&lane->probes, engine->table.device_count) ||
	    due_set_init(&lane->watch, engine->table.device_count) ||
	    due_set_init(&lane->restarts, engine->table.device_count) ||
	    alarm_init(&lane->alarm, engine->alarm_count, port->searches)) {
		lane_free(lane);
		return -ENOMEM;
	}
	return 0;
}

void lane_free(struct lane *lane)
{
	slots_free(lane);
	due_set_free(&lane->inputs);
	due_set_free(&lane->outputs);
	due_set_free(&lane->probes);
	due_set_free(&lane->watch);
	due_set_free(&lane->restarts);
	alarm_free(&lane->alarm);
}

void lane_take_row(struct lane *lane, uint32_t row)
{
	struct signal *s = &lane->engine->table.signals[row];

	s->lane = lane->index;
	lane->writers += signal_writes(s);
}

void lane_drop_row(struct lane *lane, uint32_t row)
{
	due_set_remove(&lane->inputs, row);
	due_set_remove(&lane->outputs, row);
	lane->writers -= signal_writes(&lane->engine->table.signals[row]);
}
