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

/* --- A message for each entity, as Home Assistant before 2024.11 takes them ------------------- */

#define PLATFORM "\":{\"p\":\""

/* Behind the object at which a text of ours is. */
static const char *object_end(const char *at)
{
	bool text = false;
	int depth = 0;

	for (; *at; at++) {
		if (*at == '\\' && at[1])
			at++;
		else if (*at == '"')
			text = !text;
		else if (!text && *at == '{')
			depth++;
		else if (!text && *at == '}' && !--depth)
			return at + 1;
	}
	return at;
}

static size_t platform_len(const char *platform)
{
	return strspn(platform, "abcdefghijklmnopqrstuvwxyz_");
}

/* The topics of all entities of this node, with wildcards, or of one. */
static void entity_topic(const struct stream *s, const char *platform, size_t len, const char *id,
                         size_t id_len, char topic[TOPIC_SIZE])
{
	char node[ENTITY_ID];

	topic_id(s->node, node, sizeof(node));
	snprintf(topic, TOPIC_SIZE, "%s/%.*s/owsd_%s/%.*s/config", s->discovery, (int)len, platform,
	         node, (int)id_len, id);
}

/* The message of a device as those of its components, each with what they have in common. */
static bool put_each(struct stream *s)
{
	char *all = strndup(s->text, s->len), topic[TOPIC_SIZE];
	const char *there = all ? strstr(all, ",\"avty\":[") : NULL;
	const char *mode = there ? strstr(there, ",\"avty_mode\"") : NULL;
	const char *parts = mode ? strstr(mode, ",\"cmps\":{") : NULL;
	bool put = parts;
	int number = 0;

	for (const char *at = parts ? strchr(parts, '{') + 1 : ""; put && *at == '"'; at++) {
		const char *id = at + 1, *part, *platform;
		size_t id_len = strcspn(id, "\"");

		part = id + id_len + 2;
		platform = id + id_len + strlen(PLATFORM);
		at = object_end(part);
		/* the outlet has taken it before */
		if (number++ < s->each)
			continue;
		rewind(s->out);
		fwrite(all, 1, (size_t)(there - all), s->out);
		/* it may have one of its own */
		if (!memmem(part, (size_t)(at - part), "\"avty\":[", 8))
			fwrite(there, 1, (size_t)(mode - there), s->out);
		fwrite(mode, 1, (size_t)(parts - mode), s->out);
		fprintf(s->out, ",%.*s", (int)(at - part - 1), part + 1);
		entity_topic(s, platform, platform_len(platform), id, id_len, topic);
		put = stream_put(s, topic, true);
		s->each += put;
	}
	if (put)
		s->each = 0;
	free(all);
	return put;
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
	if (print != *had && !(s->old_readers ? put_each(s) : stream_put(s, topic, true)))
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

static bool births(const struct stream *s, int number, char topic[TOPIC_SIZE])
{
	if (number)
		entity_topic(s, "+", 1, "+", 1, topic);
	else
		snprintf(topic, TOPIC_SIZE, "%s/device/+/config", s->discovery);
	return number < 2;
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
	static const char mark[] = PLATFORM;
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
		         (int)platform_len(platform), platform);
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

static const char *outlived(struct stream *s, const char *topic, const char *text);

/* The chip that an id of a birth begins with, "28_A0B1C2000001"; NULL: none of ours. */
static struct chip *chip_of(const struct stream *s, const char *id)
{
	char text[ROM_TEXT_MAX], *mark;

	/* as it stands there it has 15 letters */
	snprintf(text, sizeof(text), "%.15s", id);
	mark = strchr(text, '_');
	if (!mark)
		return NULL;
	*mark = '.';
	return stream_chip(s, text);
}

/* An entity of this node: *is_one. "" if it is no more, or stands in the message of its device. */
static const char *entity_outlived(struct stream *s, const char *topic, bool *is_one)
{
	char present[TOPIC_SIZE], part[2 * ENTITY_ID + 64];
	size_t prefix = strlen(s->discovery) + 1, len, id_len;
	const char *platform, *id, *owner;
	struct chip *chip;

	*is_one = false;
	if (strncmp(topic, s->discovery, prefix - 1) != 0 || strlen(topic) <= prefix)
		return NULL;
	platform = topic + prefix;
	len = platform_len(platform);
	id = strrchr(topic, '/');
	if (!id || strcmp(id, "/config") != 0)
		return NULL;
	while (id > platform && id[-1] != '/')
		id--;
	id_len = strcspn(id, "/");
	entity_topic(s, platform, len, id, id_len, present);
	*is_one = !strcmp(topic, present);
	if (!*is_one)
		return NULL;
	owner = memchr(id, '_', id_len);
	chip = owner ? chip_of(s, owner + 1) : NULL;
	if (!s->old_readers || s->profile->outlived != outlived) {
		*(chip ? &chip->birth_print : &s->birth_print) = 0;
		return "";
	}
	if (chip)
		chip->seen = true; /* it is published, so it was there */
	make_device(s, chip, present);
	snprintf(part, sizeof(part), "\"%.*s" PLATFORM "%.*s\"", (int)id_len, id, (int)len,
	         platform);
	return fflush(s->out) || memmem(s->text, s->len, part, strlen(part)) ? NULL : "";
}

static const char *outlived(struct stream *s, const char *topic, const char *text)
{
	char id[ENTITY_ID], present[TOPIC_SIZE], *parts;
	struct chip *chip = NULL;
	const char *entity;
	bool node, is_one;

	entity = entity_outlived(s, topic, &is_one);
	if (is_one)
		return entity;
	if (strnlen(text, BIRTH_MOST) == BIRTH_MOST || !is_ours(s, topic, text, id, &node))
		return NULL;
	if (s->profile->outlived != outlived)
		return "";
	if (!node)
		chip = chip_of(s, id);
	if (!node && !chip)
		return "";
	if (s->old_readers) {
		*(chip ? &chip->birth_print : &s->birth_print) = 0;
		return "";
	}
	if (chip)
		chip->seen = true; /* it is published, so it was there */
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
