/* SPDX-License-Identifier: MIT */
/* The state of owsd, its targets, devices and counters as JSON. */
#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

#include "src/faces/show/faces.h"
#include "src/faces/show/stats.h"

#define ANSWERS_LEAST 1000 /* from which on the share of the errors says something */
#define ANSWERS_PER_ERROR 100

bool health_is_key(const struct ows_info *info)
{
	const char *property = strrchr(info->path, '/');

	return (!strncmp(info->device, "01.", 3) || !strncmp(info->device, "81.", 3)) && property &&
	       !strcmp(property, "/present");
}

int health_find(struct ows *h, const char *id, struct ows_device *device)
{
	int low = 0, high = 1;

	while (high < ows_count(h) && ows_device(h, high, device) != -ENOENT)
		high *= 2;
	while (low < high) {
		int middle = low + (high - low) / 2, err = ows_device(h, middle, device);
		int order = err == -ENOENT ? 1 : err ? -1 : strcasecmp(device->id, id);

		if (!order)
			return middle;
		if (order < 0)
			low = middle + 1;
		else
			high = middle;
	}
	return -1;
}

enum device_health health_of_wire(const struct ows_device *device)
{
	return device->answers >= ANSWERS_LEAST &&
	                       device->errors > device->answers / ANSWERS_PER_ERROR
	               ? HEALTH_MAINTENANCE
	               : HEALTH_NORMAL;
}

enum device_health health_of_signal(const struct ows_info *info, uint8_t quality, bool simulated)
{
	if (health_is_key(info) || (info->output && quality == OWS_Q_INITIAL))
		return HEALTH_NORMAL;
	return ows_good(quality) && simulated ? HEALTH_CHECK : quality_health(quality);
}

enum device_health health_worse(enum device_health a, enum device_health b)
{
	if (a == HEALTH_NORMAL || b == HEALTH_NORMAL)
		return a == HEALTH_NORMAL ? b : a;
	return a < b ? a : b;
}

void health_devices(struct ows *h, int64_t now_ns, enum device_health *healths, int count)
{
	struct ows_device device;
	struct ows_value value;
	struct ows_info info;

	for (int i = 0; i < count; i++)
		healths[i] = ows_device(h, i, &device) ? HEALTH_CHECK : health_of_wire(&device);
	for (int i = 0; i < ows_count(h); i++) {
		int index = -1, err;

		if (ows_info(h, i, &info) == 0 && *info.device)
			index = health_find(h, info.device, &device);
		if (index < 0 || index >= count)
			continue;
		err = ows_get_signal(h, i, now_ns, &value);
		healths[index] = health_worse(
			healths[index],
			err && err != -ESTALE
				? HEALTH_CHECK
				: health_of_signal(&info, value.quality,
		                                   value.detail & OWS_DETAIL_SIMULATED));
	}
}

/* --- The state of owsd ----------------------------------------------------------------------- */

const char *stats_daemon_state(const struct ows_daemon *daemon)
{
	switch (daemon->state) {
	case 1:
		return daemon->alive ? "live" : "dead";
	case 2:
		return "retired";
	case 3:
		return "stopped";
	}
	return "unknown";
}

const char *stats_target_state(uint32_t state)
{
	static const char *const names[] = {"down", "up", "suspended"};

	return state < 3 ? names[state] : "unknown";
}

int stats_not_good(struct ows *h, int64_t now_ns)
{
	struct ows_value value;
	int count = 0;

	for (int i = 0; i < ows_count(h); i++)
		count += ows_get_signal(h, i, now_ns, &value) != 0 || !ows_good(value.quality);
	return count;
}

void stats_served(struct ows *h, int64_t now_ns, unsigned served[STATS_TARGETS + 1])
{
	struct ows_value value;

	memset(served, 0, (STATS_TARGETS + 1) * sizeof(*served));
	for (int i = 0; i < ows_count(h); i++)
		if (ows_get_signal(h, i, now_ns, &value) == 0 && value.target < STATS_TARGETS)
			served[value.target]++;
}

enum device_health *stats_healths(struct ows *h, int64_t now_ns)
{
	struct ows_device device;
	enum device_health *healths;
	int count = 0;

	while (ows_device(h, count, &device) != -ENOENT)
		count++;
	healths = calloc((size_t)count + 1, sizeof(*healths));
	if (healths)
		health_devices(h, now_ns, healths, count);
	return healths;
}

const char *stats_power(uint32_t power)
{
	switch (power) {
	case OWS_POWER_PARASITE:
		return "parasite";
	case OWS_POWER_EXTERNAL:
		return "external";
	}
	return NULL;
}

bool stats_device_costs(const struct ows_device *device)
{
	return device->wire_us != 0;
}

static void cost_json(struct json *json, const char *key, const struct ows_device *device,
                      uint64_t number)
{
	if (stats_device_costs(device))
		json_uint(json, key, number);
	else
		json_null(json, key);
}

static void device_json(struct json *json, struct ows *h, const struct ows_device *device,
                        enum device_health health, int64_t now_ns)
{
	struct ows_target target;

	json_object(json, NULL);
	json_string(json, "id", device->id);
	json_string(json, "family", *device->family ? device->family : NULL);
	json_string(json, "identity", *device->identity ? device->identity : NULL);
	json_string(json, "power", stats_power(device->power));
	json_string(json, "health", health_word(health));
	json_string(json, "target",
	            ows_target(h, device->target, &target) == 0 ? target.name : NULL);
	json_known(json, "channel", (int32_t)device->wire - 1);
	json_uint(json, "answers", device->answers);
	json_uint(json, "errors", device->errors);
	cost_json(json, "retries", device, device->retries);
	cost_json(json, "wire_us", device, device->wire_us);
	if (device->ok_ns)
		json_seconds(json, "last_ok_age", now_ns - device->ok_ns);
	else
		json_null(json, "last_ok_age");
	json_object_end(json);
}

void stats_whose(struct json *json, const char *instance)
{
	char host[HOST_NAME_MAX + 1] = "";

	gethostname(host, sizeof(host) - 1);
	json_string(json, "instance", instance);
	json_string(json, "host", *host ? host : NULL);
}

static void refused_json(struct json *json, struct ows *h, const struct when *now)
{
	struct ows_log_line line;
	char text[WHEN_TEXT];

	if (ows_refused_reload(h, &line)) {
		json_null(json, "refused_reload");
		return;
	}
	json_object(json, "refused_reload");
	json_uint(json, "count", line.number);
	json_string(json, "time", when_iso(now, line.time_ns, text));
	json_string(json, "why", line.text);
	json_object_end(json);
}

void stats_json(struct json *json, const char *instance, struct ows *h,
                const struct ows_daemon *daemon, const struct when *now)
{
	char text[WHEN_TEXT];
	enum device_health *healths;
	unsigned served[STATS_TARGETS + 1];
	struct ows_target target;
	struct ows_log_line note;
	struct ows_counter counter;
	struct ows_device device;
	int err;

	stats_served(h, now->boot, served);
	stats_whose(json, instance);
	json_object(json, "daemon");
	json_int(json, "pid", daemon->pid);
	json_string(json, "state", stats_daemon_state(daemon));
	json_bool(json, "alive", daemon->alive);
	json_string(json, "started", when_iso(now, daemon->start_ns, text));
	json_seconds(json, "uptime", now->boot - daemon->start_ns);
	json_uint(json, "generation", daemon->generation);
	refused_json(json, h, now);
	json_seconds(json, "period", daemon->period_ns);
	json_seconds(json, "heartbeat_age", daemon->beat_age_ns);
	json_string(json, "last_heartbeat", when_iso(now, now->boot - daemon->beat_age_ns, text));
	json_object_end(json);
	json_int(json, "signals", ows_count(h));
	json_int(json, "not_good", stats_not_good(h, now->boot));
	json_string(json, "served", ows_served(h));
	json_array(json, "targets");
	for (int i = 0; i < STATS_TARGETS && ows_target(h, i, &target) == 0; i++) {
		json_object(json, NULL);
		json_string(json, "name", target.name);
		json_string(json, "state",
		            daemon->alive ? stats_target_state(target.state) : "unknown");
		json_string(json, "last_state", stats_target_state(target.state));
		json_string(json, "note", ows_target_note(h, i, &note) ? NULL : note.text);
		json_uint(json, "reconnects", target.reconnects);
		json_uint(json, "wire", target.group);
		json_uint(json, "signals", served[i]);
		json_uint(json, "moves", target.moves);
		json_object_end(json);
	}
	json_array_end(json);
	json_array(json, "devices");
	healths = stats_healths(h, now->boot);
	for (int i = 0; healths && (err = ows_device(h, i, &device)) != -ENOENT; i++)
		if (!err)
			device_json(json, h, &device, healths[i], now->boot);
	free(healths);
	json_array_end(json);
	json_array(json, "counters");
	for (int i = 0; ows_counter(h, i, &counter) == 0; i++) {
		json_object(json, NULL);
		json_string(json, "name", counter.name);
		json_string(json, "target",
		            ows_target(h, counter.target, &target) == 0 ? target.name : NULL);
		json_uint(json, "value", counter.value);
		json_object_end(json);
	}
	json_array_end(json);
	faces_json(json, "faces", instance, now);
}
