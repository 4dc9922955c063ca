/* SPDX-License-Identifier: MIT */
/*
 * The profile "homeassistant": plain, and a birth that has Home Assistant make a device of each
 * chip, by its ROM id, and one of the node.
 */
#include <string.h>

#include "src/mqtt/entity.h"
#include "src/mqtt/health.h"
#include "src/mqtt/plain.h"

/* The components of all rows of a chip; NULL: of those without one. */
static void put_rows(struct json *json, const struct stream *s, const struct chip *chip,
                     const char *owner)
{
	int first = chip ? chip->first : 0;
	bool alone = chip && chip->rows == 1;

	for (int i = first; i < s->count && s->by_chip[i]->chip == s->by_chip[first]->chip; i++)
		if (chip || s->by_chip[i]->chip < 0)
			entity_json(json, s, s->by_chip[i], owner, alone);
}

/* A chip with one signal has the name of that. */
static void name_chip(const struct stream *s, const struct chip *chip, char *name, size_t size)
{
	const struct ows_info *info = &s->by_chip[chip->first]->info;

	if (chip->rows == 1)
		snprintf(name, size, "%s", *info->description ? info->description : info->name);
	else
		snprintf(name, size, "%s %s", *chip->family ? chip->family : "1-Wire", chip->id);
}

static bool say_device(struct stream *s, int number)
{
	struct chip *chip = number >= 0 ? &s->chips[number] : NULL;
	char name[256], topic[TOPIC_SIZE], owner[ENTITY_ID];
	struct json json;

	if (chip)
		name_chip(s, chip, name, sizeof(name));
	else
		snprintf(name, sizeof(name), "owsd %s", s->node);
	topic_id(chip ? chip->id : s->node, owner, sizeof(owner));
	stream_message(s, &json);
	json_object(&json, NULL);
	entity_device_json(&json, s, chip, name);
	entity_available_json(&json, s, chip);
	json_int(&json, "qos", 1);
	json_object(&json, "cmps");
	put_rows(&json, s, chip, owner);
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

static void births(const struct stream *s, char topic[TOPIC_SIZE])
{
	snprintf(topic, TOPIC_SIZE, "%s/device/+/config", s->discovery);
}

/* The device of a chip that was behind this node, and of which there is no signal any more */
static bool outlived(const struct stream *s, const char *topic, const char *text)
{
	char behind[TOPIC_SIZE], id[ENTITY_ID], start[TOPIC_SIZE];
	size_t len = (size_t)snprintf(start, sizeof(start), "%s/device/owsd_", s->discovery);

	snprintf(behind, sizeof(behind), "\"via_device\":\"owsd_%s\"", s->node);
	if (strncmp(topic, start, len) != 0 || !strstr(text, behind))
		return false;
	/* "28_A0B1C2000001/config" */
	snprintf(id, sizeof(id), "%.*s", (int)strcspn(topic + len, "/"), topic + len);
	id[strcspn(id, "_")] = '.';
	return !stream_chip(s, id);
}

const struct profile profile_homeassistant = {
	.name = "homeassistant",
	.birth = birth,
	.value = plain_value,
	.state = plain_state,
	.alarm = plain_alarm,
	.listen = listen,
	.heard = heard,
	.births = births,
	.outlived = outlived,
};
