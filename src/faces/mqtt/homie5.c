/* SPDX-License-Identifier: MIT */
/*
 * The profile "homie5": the node is a device of the Homie convention 5, each chip a node of it, and
 * each signal a property. Homie has no quality: of a bad value nothing is retained, and an alert of
 * the device says why; or that a limit alarm of it stands, or that it is simulated.
 */
#include <math.h>
#include <string.h>
#include <time.h>

#include "src/faces/mqtt/entity.h"
#include "src/faces/mqtt/plain.h"
#include "src/faces/mqtt/stream.h"
#include "src/ground/signal/hash.h"
#include "src/ground/signal/value.h"

#define DASH '-'
#define STATE "$state"
#define DESCRIPTION "$description"
#define ALERT "$alert/"

static const char *node_id(const struct row *row, char id[ENTITY_ID])
{
	topic_slug(*row->chip_id ? row->chip_id : "signals", DASH, id, ENTITY_ID);
	return id;
}

/* By the identity: a name is a label. */
static const char *property_id(const struct row *row, char id[ENTITY_ID])
{
	size_t len;

	topic_slug(row->property, DASH, id, ENTITY_ID);
	len = strlen(id);
	if (row->twice)
		snprintf(id + len, ENTITY_ID - len, "%c%s", DASH, row->level);
	return id;
}

static void topic_of(const struct stream *s, const struct row *row, char topic[TOPIC_SIZE])
{
	char node[ENTITY_ID], property[ENTITY_ID];

	snprintf(topic, TOPIC_SIZE, "%.300s/%s/%s", s->prefix, node_id(row, node),
	         property_id(row, property));
}

/* --- The description ------------------------------------------------------------------------- */

static const char *datatype(const struct ows_info *info)
{
	return info->type == OWS_BOOL                      ? "boolean"
	       : info->type == OWS_STRING                  ? "string"
	       : value_is_float((enum ows_type)info->type) ? "float"
	                                                   : "integer";
}

/* A bound of a format, without the sign '+' of an exponent, which Homie has not. */
static void put_bound(char *format, size_t size, double bound)
{
	size_t len = strlen(format);
	char *sign;

	snprintf(format + len, size - len,
	         fabs(bound) < 1e15 && bound == rint(bound) ? "%.0f" : "%.9g", bound);
	sign = strchr(format + len, '+');
	if (sign)
		memmove(sign, sign + 1, strlen(sign));
}

/* The range of a number: of the configuration; of a whole number that is set that of its type. */
static void put_format(struct json *json, const struct ows_info *info, bool settable)
{
	bool typed = settable && !value_is_float((enum ows_type)info->type) &&
	             info->type != OWS_LARGE;
	char format[96] = "";
	double least, most;
	size_t len;

	if (info->type == OWS_BOOL || info->type == OWS_STRING)
		return;
	entity_range(info, &least, &most);
	if (typed || !isnan(info->min))
		put_bound(format, sizeof(format), least);
	len = strlen(format);
	snprintf(format + len, sizeof(format) - len, ":");
	if (typed || !isnan(info->max))
		put_bound(format, sizeof(format), most);
	if (format[1])
		json_string(json, "format", format);
}

static void put_property(struct json *json, const struct stream *s, const struct row *row)
{
	const struct ows_info *info = &row->info;
	bool settable = s->write && info->output;
	char id[ENTITY_ID];

	json_object(json, property_id(row, id));
	json_string(json, "name", *info->description ? info->description : info->name);
	json_string(json, "datatype", datatype(info));
	put_format(json, info, settable);
	if (*info->unit)
		json_string(json, "unit", info->unit);
	json_bool(json, "settable", settable);
	json_bool(json, "retained", true);
	json_object_end(json);
}

static void put_nodes(struct json *json, const struct stream *s)
{
	char text[ENTITY_ID];

	json_object(json, "nodes");
	for (int i = 0; i < s->count; i++) {
		const struct row *row = s->by_chip[i];

		if (!i || row->chip != s->by_chip[i - 1]->chip) {
			json_object(json, node_id(row, text));
			snprintf(text, sizeof(text), "%.60s%s%.60s", row->info.family,
			         *row->info.family && *row->chip_id ? " " : "", row->chip_id);
			json_string(json, "name", *text ? text : "Signals");
			if (*row->info.family)
				json_string(json, "type", row->info.family);
			json_object(json, "properties");
		}
		put_property(json, s, row);
		if (i + 1 == s->count || s->by_chip[i + 1]->chip != row->chip) {
			json_object_end(json);
			json_object_end(json);
		}
	}
	json_object_end(json);
}

/* Another description has a higher version, in other runs too: a time, if the clock goes. */
static void renew_version(struct stream *s, uint64_t print)
{
	int64_t now_s = (int64_t)time(NULL);

	if (s->description && print == s->described)
		return;
	s->described = print;
	s->description = now_s > s->description ? now_s : s->description + 1;
}

static bool describe(struct stream *s)
{
	char name[ENTITY_ID + 8];
	struct json json;

	snprintf(name, sizeof(name), "owsd %s", s->node);
	stream_message(s, &json);
	json_object(&json, NULL);
	json_string(&json, "homie", "5.0");
	json_string(&json, "name", name);
	json_string(&json, "type", "owsd");
	put_nodes(&json, s);
	if (fflush(s->out))
		return false;
	renew_version(s, hash_text(HASH_BEGIN, s->text, s->len));
	json_int(&json, "version", s->description);
	json_object_end(&json);
	return stream_put_below(s, DESCRIPTION, NULL);
}

/* The description may change while the device is "init"; it is ready again after the values. */
static bool birth(struct stream *s, int number, bool *more)
{
	*more = !number && !s->announced;
	if (s->announced)
		return true;
	if (!number) {
		s->online = false;
		return stream_put_below(s, STATE, "init");
	}
	s->announced = describe(s);
	return s->announced;
}

/* --- Values and states ----------------------------------------------------------------------- */

/* The one alert of a row, if it is another than was published. */
static bool put_alert(struct stream *s, struct row *row, const struct news *news)
{
	char below[TOPIC_SIZE], text[256] = "";
	struct ows_alarm_state state;
	const char *why = "", *more = "";
	uint32_t print;

	if (!news->value.good) {
		/* the state says that owsd is lost, and an output may wait for a command */
		if (s->live && news->value.v.quality != OWS_Q_INITIAL)
			why = ows_quality_text(news->value.v.quality);
	} else if (plain_limit(s, row, &state) && plain_stands(&state)) {
		why = ows_alarm_kind_text(state.limit_kind);
		more = " alarm";
	} else if (news->value.simulated) {
		why = "simulated";
	}
	if (*why)
		snprintf(text, sizeof(text), "%s: %s%s", row->name, why, more);
	print = (uint32_t)hash_text(HASH_BEGIN, text, strlen(text)) | 1;
	if (print == row->alarm_print)
		return true;
	snprintf(below, sizeof(below), ALERT "%s", row->level);
	if (!stream_put_below(s, below, text))
		return false;
	row->alarm_print = print;
	return true;
}

static bool value(struct stream *s, struct row *row)
{
	struct news news;
	bool put;

	if (!stream_read(s, row, &news))
		return put_alert(s, row, &news);
	if (!news.value.good)
		return stream_put_text(s, row->topic, "", true) && put_alert(s, row, &news) &&
		       stream_published(row, &news);
	stream_value(s, &news, "true", "false");
	/* an empty text would empty the topic: it is one byte 0 */
	put = *news.value.text ? stream_put(s, row->topic, true)
	                       : s->outlet.put(s->outlet.ctx, row->topic, "", 1, true);
	return put && put_alert(s, row, &news) && stream_published(row, &news);
}

static bool homie5_state(struct stream *s, enum stream_node node)
{
	static const char *const words[] = {[STREAM_THERE] = "ready",
	                                    [STREAM_LOST] = "lost",
	                                    [STREAM_KILLED] = "lost",
	                                    [STREAM_ENDED] = "disconnected"};

	return stream_put_below(s, STATE, words[node]);
}

static bool writes(const struct stream *s, const char *topic, const char *below)
{
	if (!strcmp(below, STATE) || !strcmp(below, DESCRIPTION))
		return true;
	if (strncmp(below, ALERT, strlen(ALERT)) != 0)
		return stream_row(s, topic, strlen(topic));
	for (int i = 0; i < s->count; i++)
		if (!strcmp(s->rows[i].level, below + strlen(ALERT)))
			return true;
	return false;
}

static const char *const places[] = {"+", "+/+", NULL};

const struct profile profile_homie5 = {
	.name = "homie5",
	.root = "homie/5/owsd-",
	.dash = DASH,
	.qos = 2,
	.commands = "+/+/set",
	.below = places,
	.writes = writes,
	.topic = topic_of,
	.birth = birth,
	.value = value,
	.state = homie5_state,
};
