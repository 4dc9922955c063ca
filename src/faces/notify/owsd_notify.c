/* SPDX-License-Identifier: MIT */
/* owsd-notify: tells people of the alarms of an owsd, by mail, webhook or command. */
#include "src/faces/kit/loop.h"
#include "src/faces/notify/notify.h"

int main(int argc, char **argv)
{
	static const struct face_ops ops = {
		.program = "owsd-notify",
		.option = {'t', "test", NULL, "send a test message each way, and end"},
		.check = notify_check,
		.open = notify_start,
		.changes = notify_changes,
		.event = notify_event,
		.tick = notify_tick,
		.report = notify_report,
		.close = notify_end,
	};

	return face_main(&ops, argc, argv);
}
