/* SPDX-License-Identifier: MIT */
/* A device that was absent is there again, or has restarted. */
#include "src/engine/device_back.h"
#include "src/engine/alarm/alarm_arm.h"
#include "src/engine/retry.h"
#include "src/engine/schedule.h"

void engine_device_back(struct lane *lane, struct device *device)
{
	struct engine *e = lane->engine;

	device->absent = false;
	device->por = POR_UNKNOWN;
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
	}
}
