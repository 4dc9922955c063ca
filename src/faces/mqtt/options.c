/* SPDX-License-Identifier: MIT */
/* What stands in the Mqtt block, as owsd-mqtt keeps it. */
#include <ctype.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "src/faces/kit/face.h"
#include "src/faces/mqtt/options.h"
#include "src/faces/mqtt/profiles.h"

static void options_copy(char *to, size_t size, const char *text)
{
	snprintf(to, size, "%s", text ? text : "");
}

/* "pi7", "pi7-HOUSE": a host's own name, with what a topic's level may have. */
static void name_node(struct mqtt_options *options, const struct face *face)
{
	const char *instance = face->arguments->instance;
	char host[64] = "";

	if (face->config->mqtt.node) {
		options_copy(options->node, sizeof(options->node), face->config->mqtt.node);
		return;
	}
	if (gethostname(host, sizeof(host) - 1) || !*host || *host == '.')
		options_copy(host, sizeof(host), "owsd");
	host[strcspn(host, ".")] = '\0';
	snprintf(options->node, sizeof(options->node), "%s%s%.60s", host,
	         strcmp(instance, "OWS") != 0 ? "-" : "",
	         strcmp(instance, "OWS") != 0 ? instance : "");
	for (char *c = options->node; *c; c++)
		if (!isalnum((unsigned char)*c) && !strchr("-_.", *c))
			*c = '_';
}

/*
 * Where a person finds the page of this instance: as a block says; else where the page listens, if
 * that is an address which others reach by its number.
 */
static void name_page(struct mqtt_options *options, const struct config *config)
{
	static const uint8_t any[sizeof(config->web.addresses[0].bytes)];
	const char *link = config->mqtt.link ? config->mqtt.link : config->notify.link;
	char text[LISTEN_TEXT_MAX];

	options_copy(options->link, sizeof(options->link), link);
	for (unsigned i = 0; i < config->web.address_count && !*options->link; i++) {
		const struct listen_address *address = &config->web.addresses[i];

		if (!address->port || listen_is_loopback(address) ||
		    !memcmp(address->bytes, any, address->is_v6 ? 16 : 4))
			continue;
		listen_print(address, text);
		snprintf(options->link, sizeof(options->link), "http://%s/", text);
	}
}

void mqtt_options_take(struct mqtt_options *options, const struct face *face)
{
	const struct config_mqtt *mqtt = &face->config->mqtt;

	memset(options, 0, sizeof(*options));
	for (unsigned i = 0; i < mqtt->way_count; i++) {
		options_copy(options->ways[i].host, OPTION_SIZE, mqtt->ways[i].host);
		options->ways[i].port = mqtt->ways[i].port;
		options->ways[i].tls = mqtt->ways[i].tls;
	}
	options->way_count = mqtt->way_count;
	options_copy(options->password_file, OPTION_SIZE, mqtt->password_file);
	options_copy(options->ca_file, OPTION_SIZE, mqtt->ca_file);
	options_copy(options->cert_file, OPTION_SIZE, mqtt->cert_file);
	options_copy(options->key_file, OPTION_SIZE, mqtt->key_file);
	name_node(options, face);
	/* so a thousand machines have one and the same file */
	options_copy(options->user, OPTION_SIZE,
	             !mqtt->user && mqtt->password_file ? options->node : mqtt->user);
	options_copy(options->topic, sizeof(options->topic), mqtt->topic);
	options->profile = profiles_find(mqtt->profile);
	profiles_prefix(options->profile, options->topic, options->node, options->prefix);
	options_copy(options->discovery, sizeof(options->discovery), mqtt->discovery);
	options_copy(options->primary_host, sizeof(options->primary_host), mqtt->primary_host);
	name_page(options, face->config);
	options->mqtt5 = mqtt->mqtt5;
	options->write = mqtt->write;
	options->rename = mqtt->rename;
	options->old_readers = mqtt->old_readers;
}

const char *mqtt_way_name(const struct mqtt_way *way, char text[MQTT_WAY_NAME])
{
	bool v6 = strchr(way->host, ':');

	snprintf(text, MQTT_WAY_NAME, "mqtt%s://%s%s%s:%u", way->tls ? "s" : "", v6 ? "[" : "",
	         way->host, v6 ? "]" : "", (unsigned)way->port);
	return text;
}
