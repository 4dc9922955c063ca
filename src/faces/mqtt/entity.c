/* SPDX-License-Identifier: MIT */
/* Writes the components of discovery, with the abbreviations of Home Assistant's keys. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "hal/base/time.h"
#include "src/faces/mqtt/entity.h"
#include "src/faces/mqtt/plain.h"
#include "src/faces/show/stats.h"
#include "src/ground/signal/unit.h"
#include "src/ground/signal/value.h"

#define GOOD_OR_NONE " if value_json.good else None }}"
/* A cover takes no None before 2025 */
#define GOOD_OR_EMPTY " if value_json.good else '' }}"
/* Of a brightness and a position Home Assistant takes no None: they stay, the state is unknown */
#define NUMBER_OR_NOTHING "{{ value_json.v if value_json.good else '' }}"
#define MARGIN_NS (5 * NS_PER_S)
#define TEXT_MOST 255 /* of a state */

static const struct {
	const char *platform, *template;
} kinds[] = {
	[ENTITY_SENSOR] = {"sensor", "{{ value_json.v" GOOD_OR_NONE},
	[ENTITY_BINARY] = {"binary_sensor", "{{ ('ON' if value_json.v else 'OFF')" GOOD_OR_NONE},
	[ENTITY_SWITCH] = {"switch", "{{ ('on' if value_json.v else 'off')" GOOD_OR_NONE},
	[ENTITY_NUMBER] = {"number", "{{ value_json.v" GOOD_OR_NONE},
	[ENTITY_LIGHT] = {"light", "{{ ('on' if value_json.v else 'off')" GOOD_OR_NONE},
	[ENTITY_COVER] = {"cover", "{{ ('open' if value_json.v else 'closed')" GOOD_OR_EMPTY},
	[ENTITY_TEXT] = {"text", "{{ value_json.v[:255]" GOOD_OR_NONE},
};

static const char *class_of(const struct row *row)
{
	const struct ows_info *info = &row->info;
	const char *class;

	if (*row->class)
		return row->class;
	if (!strcmp(info->unit, "%") && strstr(row->property, "humidity"))
		return "humidity";
	class = unit_class(info->unit);
	return class ? class : "";
}

enum entity_kind entity_kind(const struct ows_info *info, const char *class, bool write)
{
	bool text = info->type == OWS_STRING;
	bool words = info->type == OWS_BOOL || (!text && !isnan(info->min) && !isnan(info->max));

	if (!write || !info->output)
		return info->type == OWS_BOOL ? ENTITY_BINARY : ENTITY_SENSOR;
	if (words && !strcmp(class, "light"))
		return ENTITY_LIGHT;
	if (words && !strcmp(class, "cover"))
		return ENTITY_COVER;
	return text ? ENTITY_TEXT : info->type == OWS_BOOL ? ENTITY_SWITCH : ENTITY_NUMBER;
}

void entity_range(const struct ows_info *info, double *least, double *most)
{
	static const double lows[] = {[OWS_SHORT] = -32768,
	                              [OWS_LONG] = -2147483648.0,
	                              [OWS_FLOAT] = -1e6,
	                              [OWS_DOUBLE] = -1e6,
	                              [OWS_LARGE] = -1e15};
	static const double highs[] = {
		[OWS_BOOL] = 1,          [OWS_BYTE] = 255,   [OWS_SHORT] = 32767,
		[OWS_LONG] = 2147483647, [OWS_WORD] = 65535, [OWS_DWORD] = 4294967295.0,
		[OWS_FLOAT] = 1e6,       [OWS_DOUBLE] = 1e6, [OWS_LARGE] = 1e15};

	*least = !isnan(info->min) ? info->min : info->type <= OWS_LARGE ? lows[info->type] : 0;
	*most = !isnan(info->max) ? info->max : info->type <= OWS_LARGE ? highs[info->type] : 0;
}

static void put_available(struct json *json, const char *topic, const char *template)
{
	json_object(json, NULL);
	json_string(json, "t", topic);
	if (template)
		json_string(json, "val_tpl", template);
	json_object_end(json);
}

static void put_availables(struct json *json, const struct stream *s, const struct chip *chip,
                           const char *value_topic)
{
	char topic[TOPIC_SIZE];

	json_array(json, "avty");
	snprintf(topic, sizeof(topic), "%s/" TOPIC_STATE, s->prefix);
	put_available(json, topic, NULL);
	/* one that has never answered can be commanded */
	if (chip)
		put_available(json, chip->topic,
		              "{{ 'offline' if value == 'offline' else 'online' }}");
	if (value_topic)
		put_available(
			json, value_topic,
			"{{ 'online' if value_json.good or value_json.q == 32 else 'offline' }}");
	json_array_end(json);
}

void entity_available_json(struct json *json, const struct stream *s, const struct chip *chip)
{
	put_availables(json, s, chip, NULL);
	json_string(json, "avty_mode", "all");
}

const char *entity_maker(const char *family)
{
	static const struct {
		const char *begin, *maker;
	} makers[] = {
		{"DS", "Maxim Integrated"},       {"MAX", "Maxim Integrated"},
		{"EDS", "Embedded Data Systems"}, {"TMP", "Texas Instruments"},
		{"Hobby", "Hobby Boards"},        {"Inferno", "Inferno Embedded"},
	};

	for (size_t i = 0; i < sizeof(makers) / sizeof(makers[0]); i++)
		if (!strncmp(family, makers[i].begin, strlen(makers[i].begin)))
			return makers[i].maker;
	return NULL;
}

void entity_device_json(struct json *json, const struct stream *s, const struct chip *chip,
                        const char *name)
{
	char node[ENTITY_ID];

	snprintf(node, sizeof(node), "owsd_%s", s->node);
	json_object(json, "dev");
	json_array(json, "ids");
	json_string(json, NULL, chip ? chip->id : node);
	json_array_end(json);
	json_string(json, "name", name);
	json_string(json, "mdl", chip && *chip->family ? chip->family : chip ? "1-Wire" : "owsd");
	if (chip) {
		const struct ows_info *info = &s->by_chip[chip->first]->info;

		if (entity_maker(chip->family))
			json_string(json, "mf", entity_maker(chip->family));
		/* of the device that is there now */
		json_string(json, "sn", *info->device ? info->device : chip->id);
		json_string(json, "via_device", node);
	} else {
		json_string(json, "sw", OWSD_VERSION);
	}
	if (s->link && *s->link)
		json_string(json, "cu", s->link);
	json_object_end(json);
	json_object(json, "o");
	json_string(json, "name", "owsd");
	json_string(json, "sw", OWSD_VERSION);
	json_object_end(json);
}

/* --- Parts of a component -------------------------------------------------------------------- */

static void entity_begin(struct json *json, const char *id, const char *suffix,
                         const char *platform, const char *name)
{
	char text[2 * ENTITY_ID];

	snprintf(text, sizeof(text), "%s%s", id, suffix);
	json_object(json, text);
	json_string(json, "p", platform);
	json_string(json, "uniq_id", text);
	json_string(json, "name", name);
}

static void put_topic(struct json *json, const char *key, const struct row *row, const char *level)
{
	char topic[TOPIC_SIZE];

	snprintf(topic, sizeof(topic), "%s%s", row->topic, level);
	json_string(json, key, topic);
}

static void put_sensor(struct json *json, const struct row *row, enum entity_kind kind,
                       const char *class)
{
	const struct ows_info *info = &row->info;
	int64_t expire_ns = info->stale_after_ns + stream_repeat_ns(info) + MARGIN_NS;

	if (info->stale_after_ns)
		json_int(json, "exp_aft", expire_ns / NS_PER_S);
	if (kind != ENTITY_SENSOR || info->type == OWS_STRING)
		return;
	json_string(json, "stat_cla",
	            strstr(row->property, "counter") || !strcmp(class, "energy")
	                    ? "total_increasing"
	                    : "measurement");
	if (info->decimals >= 0)
		json_int(json, "sug_dsp_prc", info->decimals);
}

/* The two commands of what is on or off. */
static void put_commands(struct json *json, const struct row *row, const char *on_key,
                         const char *on, const char *off_key, const char *off)
{
	put_topic(json, "cmd_t", row, "/set");
	json_string(json, on_key, on);
	json_string(json, off_key, off);
}

static void put_number(struct json *json, const struct row *row)
{
	double least, most;

	entity_range(&row->info, &least, &most);
	put_topic(json, "cmd_t", row, "/set");
	json_double(json, "min", least);
	json_double(json, "max", most);
	json_double(json, "step",
	            !value_is_float((enum ows_type)row->info.type) ? 1
	            : row->info.decimals >= 0 && row->info.decimals < 3
	                    ? pow(10, -row->info.decimals)
	                    : 0.001);
	json_string(json, "mode", "box");
}

/* A light: on and off, or a brightness up to the greatest value. */
static void put_light(struct json *json, const struct row *row)
{
	double least, most;

	if (row->info.type == OWS_BOOL) {
		put_commands(json, row, "pl_on", "on", "pl_off", "off");
		return;
	}
	entity_range(&row->info, &least, &most);
	put_commands(json, row, "pl_on", "on", "pl_off", "off");
	json_string(json, "on_cmd_type", "brightness");
	put_topic(json, "bri_cmd_t", row, "/set");
	put_topic(json, "bri_stat_t", row, "");
	json_string(json, "bri_val_tpl", NUMBER_OR_NOTHING);
	json_double(json, "bri_scl", most);
}

/* A cover: open or closed, or a position between least and greatest value. */
static void put_cover(struct json *json, const struct stream *s, const struct row *row)
{
	double least, most;

	put_commands(json, row, "pl_open", "on", "pl_cls", "off");
	json_null(json, "pl_stop");
	if (row->info.type != OWS_BOOL) {
		entity_range(&row->info, &least, &most);
		put_topic(json, "set_pos_t", row, "/set");
		put_topic(json, "pos_t", row, "");
		json_string(json, "pos_tpl", NUMBER_OR_NOTHING);
		json_double(json, "pos_clsd", least);
		json_double(json, "pos_open", most);
	}
	/*
	 * Of one that is bad it keeps state and position; but one that nobody has set yet can be
	 * set.
	 */
	put_availables(json, s, row->chip >= 0 ? &s->chips[row->chip] : NULL, row->topic);
}

/* A light or cover that is a number is off or closed at its least value. */
static void put_state_template(struct json *json, const struct row *row, enum entity_kind kind)
{
	const char *key = kind == ENTITY_LIGHT ? "stat_val_tpl" : "val_tpl";
	bool string = kind == ENTITY_SENSOR && row->info.type == OWS_STRING;
	double least, most;
	char text[128];

	if ((kind != ENTITY_LIGHT && kind != ENTITY_COVER) || row->info.type == OWS_BOOL) {
		json_string(json, key, kinds[string ? ENTITY_TEXT : kind].template);
		return;
	}
	entity_range(&row->info, &least, &most);
	snprintf(text, sizeof(text), "{{ ('%s' if value_json.v > %.9g else '%s')%s",
	         kind == ENTITY_LIGHT ? "on" : "open", least,
	         kind == ENTITY_LIGHT ? "off" : "closed",
	         kind == ENTITY_LIGHT ? GOOD_OR_NONE : GOOD_OR_EMPTY);
	json_string(json, key, text);
}

static void put_signal(struct json *json, const struct stream *s, const struct row *row,
                       const char *id, const char *name)
{
	const struct ows_info *info = &row->info;
	const char *class = class_of(row);
	enum entity_kind kind = entity_kind(info, class, s->write);

	entity_begin(json, id, "", kinds[kind].platform, name);
	put_topic(json, "stat_t", row, "");
	put_state_template(json, row, kind);
	if (*class && strcmp(class, "light") != 0 && strcmp(class, "cover") != 0 &&
	    kind != ENTITY_LIGHT && kind != ENTITY_TEXT)
		json_string(json, "dev_cla", class);
	if (*info->unit && (kind == ENTITY_SENSOR || kind == ENTITY_NUMBER))
		json_string(json, "unit_of_meas", info->unit);
	switch (kind) {
	case ENTITY_SENSOR:
	case ENTITY_BINARY:
		put_sensor(json, row, kind, class);
		break;
	case ENTITY_SWITCH:
		put_commands(json, row, "pl_on", "on", "pl_off", "off");
		break;
	case ENTITY_NUMBER:
		put_number(json, row);
		break;
	case ENTITY_LIGHT:
		put_light(json, row);
		break;
	case ENTITY_COVER:
		put_cover(json, s, row);
		break;
	case ENTITY_TEXT:
		put_topic(json, "cmd_t", row, "/set");
		json_int(json, "max", TEXT_MOST);
		break;
	}
	/* the reason of a bad value, and nothing that changes with each reading */
	put_topic(json, "json_attr_t", row, "");
	json_string(json, "json_attr_tpl",
	            "{{ {'quality': value_json.why | default('good') ~ (', simulated' if "
	            "value_json.simulated | default(false) else '')} | tojson }}");
	json_object_end(json);
}

void entity_json(struct json *json, const struct stream *s, const struct row *row,
                 const char *owner, bool alone)
{
	const struct ows_info *info = &row->info;
	const char *name = *info->description ? info->description : info->name;
	char id[2 * ENTITY_ID], property[ENTITY_ID], title[256];

	topic_id(row->property, property, sizeof(property));
	snprintf(id, sizeof(id), "owsd_%.60s_%.100s", owner, property);
	if (row->twice) {
		topic_id(info->name, property, sizeof(property));
		snprintf(id + strlen(id), sizeof(id) - strlen(id), "_%.64s", property);
	}
	put_signal(json, s, row, id, alone ? NULL : name);
	if (row->alarms) {
		snprintf(title, sizeof(title), "%.200s alarm", alone ? "Limit" : name);
		entity_begin(json, id, "_alarm", "binary_sensor", title);
		json_string(json, "dev_cla", "problem");
		put_topic(json, "stat_t", row, "/alarm");
		json_string(json, "val_tpl", "{{ 'ON' if value_json.active else 'OFF' }}");
		put_topic(json, "json_attr_t", row, "/alarm");
		json_object_end(json);
	}
	if (info->alarm) {
		snprintf(title, sizeof(title), "%.200s event", alone ? "Device" : name);
		entity_begin(json, id, "_event", "event", title);
		json_string(json, "dev_cla", "button");
		put_topic(json, "stat_t", row, "/event");
		json_array(json, "evt_typ");
		for (int e = OWS_ALARM_RAISED; e <= OWS_ALARM_FAILED; e++)
			json_string(json, NULL, ows_alarm_event_text((uint8_t)e));
		json_array_end(json);
		json_object_end(json);
	}
	if (health_is_key(&row->info)) {
		snprintf(title, sizeof(title), "%.200s_tag", id);
		json_object(json, title);
		json_string(json, "p", "tag");
		put_topic(json, "t", row, "/tag");
		json_object_end(json);
	}
}

void entity_problem_json(struct json *json, const struct stream *s, const struct chip *chip,
                         const char *owner)
{
	char id[2 * ENTITY_ID], topic[TOPIC_SIZE];

	/* no signal has a property of that name */
	snprintf(id, sizeof(id), "owsd_%s", owner);
	entity_begin(json, id, "_problem", "binary_sensor", "Problem");
	json_string(json, "dev_cla", "problem");
	json_string(json, "ent_cat", "diagnostic");
	plain_problem_topic(s, chip, topic);
	json_string(json, "stat_t", topic);
	json_string(json, "val_tpl", "{{ 'ON' if value_json.problem else 'OFF' }}");
	json_string(json, "json_attr_t", topic);
	/* a chip that is away has a problem, and is not what says so */
	put_availables(json, s, NULL, NULL);
	json_object_end(json);
}
