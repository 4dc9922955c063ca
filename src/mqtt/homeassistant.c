/* SPDX-License-Identifier: MIT */
/*
 * The profile "homeassistant": plain, and a birth that has Home Assistant make a device of each
 * chip, by its ROM id, and one of the node.
 */
#include <string.h>

#include "src/mqtt/entity.h"
#include "src/mqtt/health.h"
#include "src/mqtt/plain.h"

/* The components of all rows of a chip; -1: of those without one. */
static void put_rows(struct json *json, const struct stream *s, int chip, const char *owner)
{
	bool alone = chip >= 0 && s->chips[chip].rows == 1;

	for (int i = 0; i < s->count; i++)
		if (s->rows[i].chip == chip)
			entity_json(json, s, &s->rows[i], owner, alone);
}

/* A chip with one signal has the name of that. */
static void name_chip(const struct stream *s, int number, char *name, size_t size)
{
	const struct chip *chip = &s->chips[number];

	for (int i = 0; chip->rows == 1 && i < s->count; i++)
		if (s->rows[i].chip == number) {
			const struct ows_info *info = &s->rows[i].info;

			snprintf(name, size, "%s",
			         *info->description ? info->description : info->name);
			return;
		}
	snprintf(name, size, "%s %s", *chip->family ? chip->family : "1-Wire", chip->id);
}

static bool say_device(struct stream *s, int number)
{
	struct chip *chip = number >= 0 ? &s->chips[number] : NULL;
	char name[256], topic[TOPIC_SIZE], owner[ENTITY_ID];
	struct json json;

	if (chip)
		name_chip(s, number, name, sizeof(name));
	else
		snprintf(name, sizeof(name), "owsd %s", s->node);
	topic_id(chip ? chip->id : s->node, owner, sizeof(owner));
	stream_message(s, &json);
	json_object(&json, NULL);
	entity_device_json(&json, s, chip, name);
	entity_available_json(&json, s, chip);
	json_int(&json, "qos", 1);
	json_object(&json, "cmps");
	put_rows(&json, s, number, owner);
	if (!chip)
		health_entities_json(&json, s, owner);
	json_object_end(&json);
	json_object_end(&json);
	snprintf(topic, sizeof(topic), "%s/device/owsd_%s/config", s->discovery, owner);
	return stream_put(s, topic, true);
}

static bool birth(struct stream *s, int number, bool *more)
{
	bool *announced = number ? &s->chips[number - 1].announced : &s->announced;

	*more = number < s->chip_count;
	if (*announced || (number && !s->chips[number - 1].seen))
		return true;
	if (!say_device(s, number - 1))
		return false;
	*announced = true;
	return true;
}

static void listen(const struct stream *s, char topic[TOPIC_SIZE])
{
	snprintf(topic, TOPIC_SIZE, "%s/status", s->discovery);
}

static bool heard(const struct stream *s, const char *topic, const char *text, size_t len)
{
	char status[TOPIC_SIZE];

	listen(s, status);
	return !strcmp(topic, status) && len == 6 && !memcmp(text, "online", 6);
}

const struct profile profile_homeassistant = {
	.name = "homeassistant",
	.birth = birth,
	.value = plain_value,
	.state = plain_state,
	.alarm = plain_alarm,
	.listen = listen,
	.heard = heard,
};
