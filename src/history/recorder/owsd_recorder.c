/* SPDX-License-Identifier: MIT */
/* owsd-recorder: keeps the history of the signals of an owsd. */
#include "src/faces/kit/loop.h"
#include "src/history/recorder/recording.h"

int main(int argc, char **argv)
{
	static const struct face_ops ops = {
		.program = "owsd-recorder",
		.option = {'d', "directory", "DIR",
	                   "where the history is kept, in place of Directory"},
		.open = recording_open,
		.changes = recording_changes,
		.event = recording_event,
		.tick = recording_tick,
		.close = recording_close,
		.report = recording_report,
	};

	return face_main(&ops, argc, argv);
}
