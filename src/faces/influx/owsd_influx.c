/* SPDX-License-Identifier: MIT */
/* owsd-influx: pushes the signals of an owsd to a server that takes InfluxDB's line protocol. */
#include "src/faces/influx/pushing.h"
#include "src/faces/kit/loop.h"
#include "src/faces/kit/secret.h"

static int check(const struct face *face)
{
	return secret_check(face->ops->program, "TokenFile", face->config->influx.token_file,
	                    SECRET_TOKEN);
}

int main(int argc, char **argv)
{
	static const struct face_ops ops = {
		.program = "owsd-influx",
		.check = check,
		.open = pushing_open,
		.changes = pushing_changes,
		.event = pushing_event,
		.tick = pushing_tick,
		.close = pushing_close,
		.report = pushing_report,
	};

	return face_main(&ops, argc, argv);
}
