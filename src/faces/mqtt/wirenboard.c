/* SPDX-License-Identifier: MIT */
/*
 * The profile "wirenboard": the node is a device of the conventions of Wiren Board, each signal a
 * control of it. At the topic of a bad value the last good one stays, so its error is all that
 * tells them apart.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "src/faces/kit/body.h"
#include "src/faces/mqtt/entity.h"
#include "src/faces/mqtt/plain.h"
#include "src/faces/mqtt/stream.h"
#include "src/ground/signal/value.h"

#define META "meta"
#define ERROR "meta/error"
#define ALARM "__alarm" /* behind the topic of a signal: no slug has two in a row */

static void topic_of(const struct stream *s, const struct row *row, char topic[TOPIC_SIZE])
{
	snprintf(topic, TOPIC_SIZE, "%s/controls/%s", s->prefix, row->level);
}

static bool put_below_row(struct stream *s, const struct row *row, const char *below,
                          const char *text)
{
	char topic[TOPIC_SIZE];

	snprintf(topic, sizeof(topic), "%s/%s", row->topic, below);
	return text ? stream_put_text(s, topic, text, true) : stream_put(s, topic, true);
}

/* --- What there is --------------------------------------------------------------------------- */

/* Units that the conventions write in ASCII. */
static const char *unit_of(const struct row *row)
{
	static const struct {
		const char *ours, *theirs;
	} units[] = {
		{"\xc2\xb0"
	         "C",
	         "deg C"},
		{"\xc2\xb0", "deg"},
		{"\xce\xa9", "Ohm"},
		{"m\xce\xa9", "mOhm"},
		{"m\xc2\xb3", "m^3"},
		{"m\xc2\xb3/h", "m^3/h"},
	};
	const char *unit = row->info.unit;

	for (size_t i = 0; i < sizeof(units) / sizeof(units[0]); i++)
		if (!strcmp(units[i].ours, unit))
			return units[i].theirs;
	if (!strcmp(unit, "%") && strstr(row->property, "humidity"))
		return "%, RH";
	for (const char *c = unit; *c; c++)
		if ((unsigned char)*c > 126)
			return "";
	return unit;
}

static void put_title(struct json *json, const char *title, bool simulated)
{
	char text[320];

	snprintf(text, sizeof(text), "%.300s%s", title, simulated ? " (simulated)" : "");
	json_object(json, "title");
	json_string(json, "en", text);
	json_object_end(json);
}

static void put_number(struct json *json, const char *key, double number)
{
	if (!isnan(number))
		json_double(json, key, number);
}

/* What meta of a control has, in s->text, at a topic for each, as the conventions had it first. */
static bool put_members(struct stream *s, const char *control)
{
	char *end = s->old_readers ? strstr(s->text, ",\"title\":") : NULL, *text;
	char topic[TOPIC_SIZE];
	struct body body;
	bool put = true;

	if (!end)
		return true;
	text = strndup(s->text, (size_t)(end - s->text) + 1);
	if (!text)
		return false;
	text[end - s->text] = '}';
	if (body_parse(text, strlen(text), &body))
		body.count = 0;
	for (unsigned i = 0; put && i < body.count; i++) {
		const struct body_member *member = &body.members[i];

		snprintf(topic, sizeof(topic), "%s/" META "/%s", control, member->key);
		put = stream_put_text(s, topic,
		                      member->kind == BODY_TRUE    ? "1"
		                      : member->kind == BODY_FALSE ? "0"
		                                                   : member->text,
		                      true);
	}
	free(text);
	return put;
}

/* What meta has: the title last, which has no topic of its own. */
static void put_meta(const struct stream *s, const struct row *row, struct json *json)
{
	const struct ows_info *info = &row->info;
	bool number = info->type != OWS_BOOL && info->type != OWS_STRING;

	json_string(json, "type",
	            info->type == OWS_BOOL     ? "switch"
	            : info->type == OWS_STRING ? "text"
	                                       : "value");
	if (number && *unit_of(row))
		json_string(json, "units", unit_of(row));
	if (number) {
		put_number(json, "min", info->min);
		put_number(json, "max", info->max);
		put_number(json, "precision",
		           !value_is_float((enum ows_type)info->type) ? 1
		           : info->decimals >= 0                      ? pow(10, -info->decimals)
		                                                      : NAN);
	}
	json_int(json, "order", row - s->rows + 1);
	json_bool(json, "readonly", !s->write || !info->output);
	put_title(json, *info->description ? info->description : info->name, row->simulated);
}

static bool put_control(struct stream *s, const struct row *row)
{
	struct json json;

	stream_message(s, &json);
	json_object(&json, NULL);
	put_meta(s, row, &json);
	json_object_end(&json);
	return put_below_row(s, row, META, NULL) && put_members(s, row->topic);
}

/* A control beside that of the signal: does its limit alarm stand? */
static void put_alarm_meta(const struct stream *s, const struct row *row, struct json *json)
{
	char title[320];

	snprintf(title, sizeof(title), "%.300s: alarm",
	         *row->info.description ? row->info.description : row->info.name);
	json_string(json, "type", "alarm");
	json_int(json, "order", s->count + (row - s->rows) + 1);
	json_bool(json, "readonly", true);
	put_title(json, title, false);
}

static bool put_alarm_control(struct stream *s, const struct row *row)
{
	char topic[TOPIC_SIZE];
	struct json json;

	if (!row->alarms)
		return true;
	stream_message(s, &json);
	json_object(&json, NULL);
	put_alarm_meta(s, row, &json);
	json_object_end(&json);
	snprintf(topic, sizeof(topic), "%s" ALARM "/" META, row->topic);
	if (!stream_put(s, topic, true))
		return false;
	topic[strlen(topic) - strlen("/" META)] = '\0';
	return put_members(s, topic);
}

/* Has put_members() a topic for that member of meta? */
static bool has_member(const struct stream *s, const struct row *row, bool alarm, const char *key)
{
	char member[32], *text;
	const char *found;
	struct json json;
	size_t len;
	bool has;

	if (!json_start(&json, &text, &len))
		return true;
	(alarm ? put_alarm_meta : put_meta)(s, row, &json);
	json_finish(&json);
	snprintf(member, sizeof(member), "\"%.24s\":", key);
	found = strstr(text, member);
	has = found && found < strstr(text, ",\"title\":");
	free(text);
	return has;
}

static bool put_device(struct stream *s)
{
	char title[ENTITY_ID + 8];
	struct json json;

	snprintf(title, sizeof(title), "owsd %s", s->node);
	stream_message(s, &json);
	json_object(&json, NULL);
	json_string(&json, "driver", "owsd");
	put_title(&json, title, false);
	json_object_end(&json);
	return stream_put_below(s, META, NULL) &&
	       (!s->old_readers || stream_put_below(s, META "/name", title));
}

static bool birth(struct stream *s, int number, bool *more)
{
	const struct row *row = number ? &s->rows[number - 1] : NULL;

	*more = number < s->count && !s->announced;
	if (!s->announced &&
	    !(row ? put_control(s, row) && put_alarm_control(s, row) : put_device(s)))
		return false;
	s->announced = s->announced || !*more;
	return true;
}

/* --- Values and states ----------------------------------------------------------------------- */

/* Not read; not written as commanded; not read in time. */
static const char *error_of(uint8_t quality)
{
	return quality == OWS_Q_DIFFERS ? "rw" : quality == OWS_Q_STALE ? "rp" : "r";
}

static bool wirenboard_put_value(struct stream *s, const struct row *row, const struct news *news)
{
	stream_value(s, news, "1", "0");
	return stream_put(s, row->topic, true);
}

/* If it is another than was published: unknown, it rests, it stands. */
static bool put_alarm(struct stream *s, struct row *row)
{
	struct ows_alarm_state state;
	bool known = plain_limit(s, row, &state), stands = known && plain_stands(&state);
	uint32_t print = 1u + known + stands;
	char topic[TOPIC_SIZE], error[TOPIC_SIZE];

	if (!row->alarms || print == row->alarm_print)
		return true;
	snprintf(topic, sizeof(topic), "%s" ALARM, row->topic);
	snprintf(error, sizeof(error), "%s" ALARM "/" ERROR, row->topic);
	if ((known && !stream_put_text(s, topic, stands ? "1" : "0", true)) ||
	    !stream_put_text(s, error, known ? "" : "r", true))
		return false;
	row->alarm_print = print;
	return true;
}

static bool value(struct stream *s, struct row *row)
{
	struct news news;

	if (!put_alarm(s, row))
		return false;
	if (!stream_read(s, row, &news))
		return true;
	/* the conventions have no other place for it that a person sees */
	if (news.value.good && news.value.simulated != row->simulated) {
		row->simulated = news.value.simulated;
		if (!put_control(s, row)) {
			row->simulated = !news.value.simulated;
			return false;
		}
	}
	if (!news.value.good)
		return put_below_row(s, row, ERROR, error_of(news.value.v.quality)) &&
		       stream_published(row, &news);
	/*
	 * The conventions have the error removed before the value comes, and the old value would
	 * count for that time. So the value comes before that, too.
	 */
	if (!wirenboard_put_value(s, row, &news) ||
	    ((!row->published || !row->good) &&
	     (!put_below_row(s, row, ERROR, "") || !wirenboard_put_value(s, row, &news))))
		return false;
	return stream_published(row, &news);
}

static bool wirenboard_state(struct stream *s, enum stream_node node)
{
	return stream_put_below(s, ERROR, node == STREAM_THERE ? "" : "r");
}

static bool writes(const struct stream *s, const char *topic, const char *below)
{
	const char *level = strchr(below, '/'), *end = level ? strchr(level + 1, '/') : NULL;
	size_t len = end ? (size_t)(end - topic) : strlen(topic), tail = strlen(ALARM);
	bool alarm = len > tail && memcmp(topic + len - tail, ALARM, tail) == 0;
	const struct row *row;

	if (!strcmp(below, META) || !strcmp(below, ERROR))
		return true;
	if (!strncmp(below, META "/", strlen(META "/")))
		return s->old_readers && !strcmp(below, META "/name");
	row = stream_row(s, topic, alarm ? len - tail : len);
	if (!row || (alarm && !row->alarms))
		return false;
	/* a member of meta, behind the topic of a control */
	return !end || strncmp(end, "/" META "/", strlen("/" META "/")) != 0 ||
	       !strcmp(end, "/" ERROR) ||
	       (s->old_readers && has_member(s, row, alarm, end + strlen("/" META "/")));
}

static const char *const places[] = {
	META, META "/+", "controls/+", "controls/+/" META, "controls/+/" META "/+", NULL};

const struct profile profile_wirenboard = {
	.name = "wirenboard",
	.root = "/devices/owsd_",
	.dash = '_',
	.qos = 1,
	.commands = "controls/+/on",
	.below = places,
	.writes = writes,
	.topic = topic_of,
	.birth = birth,
	.value = value,
	.state = wirenboard_state,
};
