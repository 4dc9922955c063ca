/* SPDX-License-Identifier: MIT */
/* The message of health, and what Home Assistant shows of it. */
#include "src/faces/mqtt/health.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "src/faces/show/stats.h"

static void put_targets(struct json *json, struct stream *s)
{
	struct ows_target target;

	json_array(json, "targets");
	for (int i = 0; i < STATS_TARGETS && !ows_target(s->h, i, &target); i++) {
		json_object(json, NULL);
		json_string(json, "name", target.name);
		json_string(json, "state", stats_target_state(target.state));
		json_object_end(json);
	}
	json_array_end(json);
}

static uint64_t count_errors(struct stream *s)
{
	struct ows_device device;
	uint64_t errors = 0;
	int err;

	for (int i = 0; (err = ows_device(s->h, i, &device)) != -ENOENT; i++)
		errors += err ? 0 : device.errors;
	return errors;
}

void health_count(struct stream *s, int64_t numbers[HEALTH_NUMBERS])
{
	struct ows_target target;

	memset(numbers, 0, HEALTH_NUMBERS * sizeof(*numbers));
	for (int i = 0; i < STATS_TARGETS && !ows_target(s->h, i, &target); i++) {
		numbers[HEALTH_DOWN] += target.state == 0;
		numbers[HEALTH_RECONNECTS] += target.reconnects;
	}
	numbers[HEALTH_BAD] = stats_not_good(s->h, ows_now());
	numbers[HEALTH_ERRORS] = (int64_t)count_errors(s);
}

bool health_publish(struct stream *s, const struct health *health)
{
	struct ows_log_line refused = {.number = 0};
	int64_t numbers[HEALTH_NUMBERS];
	struct json json;

	health_count(s, numbers);
	ows_refused_reload(s->h, &refused);
	stream_message(s, &json);
	json_object(&json, NULL);
	json_int(&json, "signals", s->count);
	json_int(&json, "bad", numbers[HEALTH_BAD]);
	json_int(&json, "errors", numbers[HEALTH_ERRORS]);
	put_targets(&json, s);
	json_int(&json, "down", numbers[HEALTH_DOWN]);
	json_int(&json, "reconnects", numbers[HEALTH_RECONNECTS]);
	json_uint(&json, "connects", health->connects);
	json_uint(&json, "refused", health->refused_messages);
	json_uint(&json, "commands", health->commands);
	json_uint(&json, "commands_refused", health->refused_commands);
	json_string(&json, "trouble", health->trouble);
	json_string(&json, "reload_refused", refused.text);
	json_object_end(&json);
	if (fflush(s->out))
		return false;
	if (s->health && !strncmp(s->health, s->text, s->len) && !s->health[s->len])
		return true;
	if (!stream_put_below(s, TOPIC_HEALTH, NULL))
		return false;
	free(s->health);
	s->health = strndup(s->text, s->len);
	return true;
}

void health_entities_json(struct json *json, const struct stream *s, const char *owner)
{
	static const struct {
		const char *id, *platform, *name, *template, *class_key, *class;
	} entities[] = {
		{"bus", "binary_sensor", "Bus", "{{ 'OFF' if value_json.down else 'ON' }}",
	         "dev_cla", "connectivity"},
		{"bad", "sensor", "Signals not good", "{{ value_json.bad }}", "stat_cla",
	         "measurement"},
		{"errors", "sensor", "Errors on the wire", "{{ value_json.errors }}", "stat_cla",
	         "total_increasing"},
		{"reconnects", "sensor", "Reconnects", "{{ value_json.reconnects }}", "stat_cla",
	         "total_increasing"},
		{"refused", "sensor", "Commands refused", "{{ value_json.commands_refused }}",
	         "stat_cla", "total_increasing"},
	};
	char id[256], topic[TOPIC_SIZE];

	snprintf(topic, sizeof(topic), "%s/" TOPIC_HEALTH, s->prefix);
	for (size_t i = 0; i < sizeof(entities) / sizeof(entities[0]); i++) {
		/* no signal has such a property */
		snprintf(id, sizeof(id), "owsd_%s_health_%s", owner, entities[i].id);
		json_object(json, id);
		json_string(json, "p", entities[i].platform);
		json_string(json, "uniq_id", id);
		json_string(json, "name", entities[i].name);
		json_string(json, "stat_t", topic);
		json_string(json, "val_tpl", entities[i].template);
		json_string(json, entities[i].class_key, entities[i].class);
		json_string(json, "ent_cat", "diagnostic");
		if (i == 0)
			json_string(json, "json_attr_t", topic);
		json_object_end(json);
	}
}
