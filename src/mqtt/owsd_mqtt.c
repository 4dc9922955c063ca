/* SPDX-License-Identifier: MIT */
/* owsd-mqtt: publishes the signals of an owsd to an MQTT broker. */
#include "src/face/loop.h"
#include "src/mqtt/mqtt.h"

static int open_mqtt(struct face *face)
{
	static struct mqtt mqtt;

	face->own = &mqtt;
	return mqtt_open(face);
}

int main(int argc, char **argv)
{
	static const struct face_ops ops = {
		.program = "owsd-mqtt",
		.open = open_mqtt,
		.changes = mqtt_changes,
		.event = mqtt_event,
		.tick = mqtt_tick,
		.report = mqtt_report,
		.close = mqtt_close,
	};

	return face_main(&ops, argc, argv);
}
