/* SPDX-License-Identifier: MIT */
/* The Mqtt block: the ways to a broker, what owsd-mqtt shows there, and what it takes. */
#include <stdlib.h>
#include <string.h>

#include "src/config/read/mqtt.h"
#include "src/config/read/options.h"
#include "src/config/read/texts.h"

#define PORT 1883
#define PORT_TLS 8883

/* ":8883", or nothing. */
static bool take_port(const char *text, size_t len, uint16_t *port)
{
	unsigned long number;
	char *end;

	if (!len)
		return true;
	if (text[0] != ':' || len < 2 || len > 6 || text[1] < '0' || text[1] > '9')
		return false;
	number = strtoul(text + 1, &end, 10);
	*port = (uint16_t)number;
	return end == text + len && number > 0 && number <= UINT16_MAX;
}

static const char *take_way(struct build *build, const char *text, size_t len,
                            struct config_mqtt_way *way)
{
	static const char wrong[] = "expected mqtt://HOST:PORT or mqtts://HOST:PORT";
	size_t scheme = len > 7 && !strncmp(text, "mqtt://", 7)    ? 7
	                : len > 8 && !strncmp(text, "mqtts://", 8) ? 8
	                                                           : 0;
	bool bracket = scheme && text[scheme] == '[';
	const char *host = text + scheme + bracket;
	size_t host_len = strcspn(host, bracket ? "]" : ":/| \t@?#"), after;

	if (scheme && memchr(text, '@', len))
		return "no password stands in it: User and PasswordFile are keys of their own";
	after = scheme + host_len + 2u * bracket;
	if (!scheme || !host_len || after > len ||
	    strspn(host, bracket ? "0123456789abcdefABCDEF:.%" : TEXT_LETTERS) < host_len)
		return wrong;
	way->tls = scheme == 8;
	way->port = way->tls ? PORT_TLS : PORT;
	if (!take_port(text + after, len - after, &way->port))
		return wrong;
	way->host = build_keep(build, host, host_len);
	return NULL;
}

static void take_ways(struct build *build, const struct rio_node *node, struct config_mqtt *mqtt)
{
	const struct rio_position at = node ? node->value_at : (struct rio_position){0};
	const char *rest = mqtt->broker, *text, *why = NULL;
	size_t len;

	while (build_part(&rest, "|", &text, &len)) {
		if (mqtt->way_count == CONFIG_MQTT_WAYS)
			why = "more than 8 ways";
		else
			why = take_way(build, text, len, &mqtt->ways[mqtt->way_count]);
		/* there may be a password in it */
		if (why && strcspn(text, "@?") < len)
			report_error(build->report, at, "Broker: %s", why);
		else if (why)
			report_error(build->report, at, "Broker \"%.*s\": %s", (int)len, text, why);
		if (why)
			return;
		mqtt->way_count++;
	}
}

static bool is_local(const char *host)
{
	return !strcmp(host, "localhost") || !strncmp(host, "127.", 4) || !strcmp(host, "::1");
}

/* Keys that need each other. What is not so by default is given, and has a position. */
static void check_together(struct build *build, const struct option_value *values,
                           const struct config_mqtt *mqtt)
{
	struct config_report *report = build->report;
	bool sparkplug = !strcmp(mqtt->profile, "sparkplug"), tls = false;
	enum option pair = mqtt->cert_file ? OPT_MQTT_CERT_FILE : OPT_MQTT_KEY_FILE;
	enum option certificate = mqtt->ca_file ? OPT_MQTT_CA_FILE : OPT_MQTT_CERT_FILE;

	for (unsigned i = 0; i < mqtt->way_count; i++)
		tls = tls || mqtt->ways[i].tls;
	if (sparkplug && strchr(mqtt->topic, '/'))
		report_error(report, values[OPT_MQTT_TOPIC].node->value_at,
		             "Topic \"%s\": the group of Sparkplug has no '/'", mqtt->topic);
	if (sparkplug && !strcmp(mqtt->topic, "STATE"))
		report_error(
			report, values[OPT_MQTT_TOPIC].node->value_at,
			"Topic \"STATE\": Sparkplug keeps this name for hosts; take another one");
	if (mqtt->primary_host && !sparkplug)
		report_warning(report, values[OPT_MQTT_PRIMARY_HOST].node->at,
		               "PrimaryHost is of the profile sparkplug alone: it is not used");
	if (!mqtt->cert_file != !mqtt->key_file)
		report_error(
			report, values[pair].node->at, "%s: CertFile and KeyFile belong together",
			mqtt->cert_file ? "CertFile without KeyFile" : "KeyFile without CertFile");
	if ((mqtt->ca_file || mqtt->cert_file) && !tls && mqtt->way_count)
		report_warning(report, values[certificate].node->at,
		               "no way of Broker is mqtts://: the certificates are not used");
	for (unsigned i = 0; mqtt->password_file && i < mqtt->way_count; i++)
		if (!mqtt->ways[i].tls && !is_local(mqtt->ways[i].host))
			report_warning(report, values[OPT_MQTT_PASSWORD_FILE].node->at,
			               "the password goes to %s in the clear: mqtts:// hides it",
			               mqtt->ways[i].host);
}

void mqtt_derive(struct build *build, const struct option_value *values)
{
	struct config_mqtt *mqtt = &build->box->config.mqtt;

	take_ways(build, values[OPT_MQTT_BROKER].node, mqtt);
	mqtt->mqtt5 = !strcmp(mqtt->protocol, "5");
	check_together(build, values, mqtt);
}
