/* SPDX-License-Identifier: MIT */
/* owsd-modbus: serves the signals of an owsd as registers of Modbus TCP. */
#include <errno.h>
#include <string.h>

#include "src/faces/kit/loop.h"
#include "src/faces/modbus/modbus.h"

/* May the file of Map be used? */
static int check(const struct face *face)
{
	const char *path = face->config->modbus.map;
	static struct map map;
	unsigned line;
	int err = path ? map_read(&map, path, &line) : 0;

	map_free(&map);
	if (err == -EINVAL)
		face_complain(face->ops->program,
		              "Map: %s:%u: expected a place from 1 to %d, a blank and an identity, "
		              "as 7 /28.FF01/temperature",
		              path, line, LAYOUT_PLACES - 1);
	else if (err)
		face_complain(face->ops->program,
		              "Map: %s: %s; owsctl modbus-map --as map prints it", path,
		              strerror(-err));
	return err == -EACCES ? 0 : err; /* the service is another user */
}

int main(int argc, char **argv)
{
	static const struct face_ops ops = {
		.program = "owsd-modbus",
		.check = check,
		.open = modbus_open,
		.changes = modbus_changes,
		.event = modbus_event,
		.tick = modbus_tick,
		.report = modbus_report,
		.close = modbus_close,
	};

	return face_main(&ops, argc, argv);
}
