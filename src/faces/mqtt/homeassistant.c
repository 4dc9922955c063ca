/* SPDX-License-Identifier: MIT */
/*
 * The profile "homeassistant": plain, and a birth that has Home Assistant make a device of each
 * chip, by its ROM id, and one of the node.
 */
#include <ctype.h>
#include <stdlib.h>
#include <string.h>

#include "src/faces/mqtt/entity.h"
#include "src/faces/mqtt/health.h"
#include "src/faces/mqtt/plain.h"
#include "src/ground/signal/hash.h"

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
		/* the device that is there now */
		snprintf(name, size, "%s %s", *chip->family ? chip->family : "1-Wire",
		         *info->device ? info->device : chip->id);
}

static void device_topic(const struct stream *s, const struct chip *chip, char owner[ENTITY_ID],
                         char topic[TOPIC_SIZE])
{
	topic_id(chip ? chip->id : s->node, owner, ENTITY_ID);
	snprintf(topic, TOPIC_SIZE, "%s/device/owsd_%s/config", s->discovery, owner);
}

static void make_device(struct stream *s, struct chip *chip, char topic[TOPIC_SIZE])
{
	char name[256], owner[ENTITY_ID];
	struct json json;

	device_topic(s, chip, owner, topic);
	if (chip)
		name_chip(s, chip, name, sizeof(name));
	else
		snprintf(name, sizeof(name), "owsd %s", s->node);
	stream_message(s, &json);
	json_object(&json, NULL);
	entity_device_json(&json, s, chip, name);
	entity_available_json(&json, s, chip);
	json_int(&json, "qos", 1);
	json_object(&json, "cmps");
	put_rows(&json, s, chip, owner);
	if (chip)
		entity_problem_json(&json, s, chip, owner);
	else
		health_entities_json(&json, s, owner);
	json_object_end(&json);
	json_object_end(&json);
}

static bool birth(struct stream *s, int number, bool *more)
{
	struct chip *chip = number ? &s->chips[number - 1] : NULL;
	bool *announced = chip ? &chip->announced : &s->announced;
	uint64_t *had = chip ? &chip->birth_print : &s->birth_print, print;
	char topic[TOPIC_SIZE];

	*more = number < s->chip_count;
	if (*announced || (chip && !chip->seen))
		return true;
	make_device(s, chip, topic);
	if (fflush(s->out))
		return false;
	print = hash_text(HASH_BEGIN, s->text, s->len);
	if (print != *had && !stream_put(s, topic, true))
		return false;
	*had = print;
	*announced = true;
	return true;
}

static void listen(const struct stream *s, char topic[TOPIC_SIZE])
{
	snprintf(topic, TOPIC_SIZE, "%s/status", s->discovery);
}

static bool heard(struct stream *s, const char *topic, const char *text, size_t len)
{
	char status[TOPIC_SIZE];

	listen(s, status);
	return !strcmp(topic, status) && len == 6 && !memcmp(text, "online", 6);
}

static void births(const struct stream *s, char topic[TOPIC_SIZE])
{
	snprintf(topic, TOPIC_SIZE, "%s/device/+/config", s->discovery);
}

/* Of what a text of the broker names no more is removed at a time; the next look takes the rest. */
#define REMOVED_MOST 1000
#define BIRTH_MOST 4000000

/*
 * Components of an old birth that the present one, in s->text, has not: each with its platform
 * alone, by which Home Assistant removes it. The caller frees them; NULL: there are none.
 */
static char *removed(const struct stream *s, const char *old)
{
	static const char mark[] = "\":{\"p\":\"";
	char part[2 * ENTITY_ID + 64], *parts = NULL;
	size_t len, count = 0;
	FILE *out = open_memstream(&parts, &len);

	if (!out)
		return NULL;
	for (const char *at = old; count < REMOVED_MOST && (at = strstr(at, mark));
	     at += strlen(mark)) {
		const char *id = at, *platform = at + strlen(mark);

		while (id > old && (isalnum((unsigned char)id[-1]) || strchr("_-", id[-1])))
			id--;
		snprintf(part, sizeof(part), "\"%.*s%s%.*s\"", (int)(at - id), id, mark,
		         (int)strspn(platform, "abcdefghijklmnopqrstuvwxyz_"), platform);
		if (memmem(s->text, s->len, part, strlen(part)))
			continue;
		fprintf(out, "%s%s}", count++ ? "," : "", part);
	}
	if (fclose(out) || !count) {
		free(parts);
		return NULL;
	}
	return parts;
}

/* The id of the topic of a birth is of a chip behind this node, or of the node: *node then. */
static bool is_ours(const struct stream *s, const char *topic, const char *text, char id[ENTITY_ID],
                    bool *node)
{
	char behind[TOPIC_SIZE], present[TOPIC_SIZE];
	size_t len;

	device_topic(s, NULL, id, present);
	*node = !strcmp(topic, present);
	if (*node)
		return true;
	len = (size_t)snprintf(id, ENTITY_ID, "%s/device/owsd_", s->discovery);
	snprintf(behind, sizeof(behind), "\"via_device\":\"owsd_%s\"", s->node);
	if (strncmp(topic, id, len) != 0 || !strstr(text, behind))
		return false;
	/* "28_A0B1C2000001/config" */
	snprintf(id, ENTITY_ID, "%.*s", (int)strcspn(topic + len, "/"), topic + len);
	return true;
}

static const char *outlived(struct stream *s, const char *topic, const char *text)
{
	char id[ENTITY_ID], present[TOPIC_SIZE], *parts, *mark;
	struct chip *chip = NULL;
	bool node;

	if (strnlen(text, BIRTH_MOST) == BIRTH_MOST || !is_ours(s, topic, text, id, &node))
		return NULL;
	if (s->profile->outlived != outlived)
		return "";
	if (!node) {
		mark = strchr(id, '_');
		if (mark) {
			*mark = '.';
			chip = stream_chip(s, id);
		}
		if (!chip)
			return "";
		chip->seen = true; /* it is published, so it was there */
	}
	make_device(s, chip, present);
	if (fflush(s->out))
		return NULL;
	parts = removed(s, text);
	if (!parts)
		return NULL;
	/* all that stays, and behind it what goes: nothing of the device is missing meanwhile */
	fseek(s->out, (long)s->len - 2, SEEK_SET);
	fprintf(s->out, ",%s}}", parts);
	free(parts);
	*(chip ? &chip->birth_print : &s->birth_print) = 0;
	return fflush(s->out) ? NULL : s->text;
}

const struct profile profile_homeassistant = {
	PLAIN,          .name = "homeassistant", .birth = birth,       .listen = listen,
	.heard = heard, .births = births,        .outlived = outlived,
};
