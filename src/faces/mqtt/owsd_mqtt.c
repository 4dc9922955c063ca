/* SPDX-License-Identifier: MIT */
/* owsd-mqtt: publishes the signals of an owsd to an MQTT broker. */
#include "src/faces/kit/loop.h"
#include "src/faces/kit/secret.h"
#include "src/faces/mqtt/arrivals.h"
#include "src/faces/mqtt/mqtt.h"

static int open_mqtt(struct face *face)
{
	static struct mqtt mqtt;

	mqtt.broker.ops = &arrivals_ops;
	face->own = &mqtt;
	return mqtt_open(face);
}

static int check(const struct face *face)
{
	const struct config_mqtt *mqtt = &face->config->mqtt;
	const struct {
		const char *key, *name;
		enum secret_kind kind;
	} files[] = {
		{"PasswordFile", mqtt->password_file, SECRET_TOKEN},
		{"CaFile", mqtt->ca_file, SECRET_PUBLIC},
		{"CertFile", mqtt->cert_file, SECRET_PUBLIC},
		{"KeyFile", mqtt->key_file, SECRET_KEY},
	};
	int worst = 0;

	for (size_t i = 0; i < sizeof(files) / sizeof(files[0]); i++) {
		int err = secret_check(face->ops->program, files[i].key, files[i].name,
		                       files[i].kind);

		worst = err ? err : worst;
	}
	return worst;
}

int main(int argc, char **argv)
{
	static const struct face_ops ops = {
		.program = "owsd-mqtt",
		.check = check,
		.open = open_mqtt,
		.changes = mqtt_changes,
		.event = mqtt_event,
		.tick = mqtt_tick,
		.report = mqtt_report,
		.close = mqtt_close,
	};

	return face_main(&ops, argc, argv);
}
