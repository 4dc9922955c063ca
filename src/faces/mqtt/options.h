/* SPDX-License-Identifier: MIT */
/* What stands in the Mqtt block, kept over the time in which the file is read again. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "src/config/read/config.h"
#include "src/faces/mqtt/stream.h"

#define OPTION_SIZE 256

struct mqtt_way {
	char host[OPTION_SIZE];
	uint16_t port;
	bool tls;
};
/* All zero but for what is set: two can be compared as memory. */
struct mqtt_options {
	struct mqtt_way ways[CONFIG_MQTT_WAYS];
	unsigned way_count;
	char user[OPTION_SIZE], password_file[OPTION_SIZE]; /* "": none */
	char ca_file[OPTION_SIZE], cert_file[OPTION_SIZE], key_file[OPTION_SIZE];
	char node[128], topic[64], prefix[TOPIC_SIZE], discovery[64];
	char primary_host[64];  /* "": none */
	char link[OPTION_SIZE]; /* of the page; "": not known */
	const struct profile *profile;
	bool mqtt5, write, rename, old_readers;
};

#define MQTT_WAY_NAME (OPTION_SIZE + 24)
/* "mqtt://localhost:1883". Returns text. */
const char *mqtt_way_name(const struct mqtt_way *way, char text[MQTT_WAY_NAME]);

struct face;
/* Node: without the key the name of this machine; beside OWS also that of the instance. */
void mqtt_options_take(struct mqtt_options *options, const struct face *face);
