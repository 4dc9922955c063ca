/* SPDX-License-Identifier: MIT */
/* Signals as JSON. */
#include <errno.h>
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

#include "hal/base/time.h"
#include "src/faces/show/present.h"
#include "src/faces/show/reading.h"
#include "src/faces/show/stats.h"
#include "src/faces/show/when.h"
#include "src/faces/web/show.h"
#include "src/ground/signal/value.h"

static void put_number(struct json *json, const char *key, struct face_value *look)
{
	if (look->v.type == OWS_LARGE)
		json_exact(json, key, look->v.integer);
	else
		reading_json_number(json, key, &look->v, face_value_text(look));
}

static void show_put_value(struct json *json, const char *key, struct face_value *look)
{
	if (look->good)
		put_number(json, key, look);
	else
		json_null(json, key);
}

static void put_age(struct json *json, const char *key, const struct face_value *look)
{
	if (look->v.measured_ns)
		json_seconds(json, key, look->v.age_ns);
	else
		json_null(json, key);
}

static void put_text(struct json *json, const char *key, const char *text)
{
	json_string(json, key, *text ? text : NULL);
}

static void put_quality(struct json *json, const struct face_value *look)
{
	json_object(json, "quality");
	json_bool(json, "good", look->good);
	json_int(json, "code", look->v.quality);
	json_string(json, "text", ows_quality_text(look->v.quality));
	put_text(json, "why", face_value_why(look));
	put_text(json, "remedy", face_value_remedy(look));
	json_object_end(json);
}

static void put_limits(struct json *json, const struct ows_info *info)
{
	if (isnan(info->limit_hh) && isnan(info->limit_h) && isnan(info->limit_l) &&
	    isnan(info->limit_ll)) {
		json_null(json, "limits");
		return;
	}
	json_object(json, "limits");
	json_double(json, "hh", info->limit_hh);
	json_double(json, "h", info->limit_h);
	json_double(json, "l", info->limit_l);
	json_double(json, "ll", info->limit_ll);
	json_object_end(json);
}

const char *show_alarm(const struct show *show, int signal, char words[SHOW_ALARM])
{
	struct ows_alarm_state state;

	words[0] = '\0';
	if (!show->live || !show->ids || show->ids[signal] < 0)
		return words;
	state = standing_of(show->h, show->ids[signal]);
	if (standing_any(&state) || state.shelved)
		standing_text(&state, words);
	return words;
}

bool show_commanded(const struct show *show, int signal, struct face_value *look)
{
	struct ows_command command;

	if (look->v.quality != OWS_Q_DIFFERS || !show->live || !show->ids ||
	    show->ids[signal] < 0 || ows_command(show->h, show->ids[signal], &command) ||
	    !command.given || command.number == look->v.number)
		return false; /* the last: set again, and not read since */
	look->v.number = command.number;
	look->v.integer = command.integer;
	return true;
}

static void put_all(struct json *json, struct face_value *look)
{
	show_put_value(json, "value", look);
	put_quality(json, look);
	put_age(json, "age", look);
	json_bool(json, "simulated", look->simulated);
}

void show_value(struct json *json, const struct show *show, int signal)
{
	struct face_value look;

	face_value(show->h, signal, show->live, show->now_ns, &look);
	put_all(json, &look);
}

static void put_terminal(struct json *json, struct ows *h, const char *id)
{
	struct ows_device device;
	struct ows_target target;

	if (!*id || health_find(h, id, &device) < 0 || ows_target(h, device.target, &target)) {
		json_null(json, "terminal");
		return;
	}
	json_object(json, "terminal");
	json_string(json, "adapter", target.name);
	json_known(json, "channel", (int)device.wire - 1);
	json_object_end(json);
}

int64_t show_interval(int64_t start_ns, const struct ows_value *v)
{
	int64_t mean, cached = v->detail & OWS_DETAIL_CACHED ? v->tried_ns - v->measured_ns : 0;

	if (!start_ns || v->count < 2 || v->measured_ns <= start_ns)
		return 0;
	mean = (v->measured_ns - start_ns) / v->count;
	return mean > cached ? mean : cached;
}

void show_signal(struct json *json, const struct show *show, int signal)
{
	char words[SHOW_ALARM];
	struct ows_info info;
	struct face_value look;
	int64_t interval;

	if (ows_info(show->h, signal, &info))
		return;
	face_value(show->h, signal, show->live, show->now_ns, &look);
	json_object(json, NULL);
	json_int(json, "i", signal);
	json_string(json, "name", info.name);
	json_string(json, "type", value_type_name((enum ows_type)info.type));
	json_bool(json, "output", info.output);
	json_bool(json, "confirm", info.confirm);
	interval = show_interval(show->start_ns, &look.v);
	if (interval && !info.output)
		json_seconds(json, "interval", interval);
	else
		json_null(json, "interval");
	json_double(json, "deadband", info.deadband);
	put_text(json, "unit", info.unit);
	json_known(json, "decimals", info.decimals);
	put_text(json, "description", info.description);
	put_text(json, "group", info.group);
	json_string(json, "path", info.path);
	json_string(json, "identity", info.identity);
	json_known(json, "modbus", places_register(show->places, info.identity));
	put_text(json, "family", info.family);
	put_text(json, "device", info.device);
	put_terminal(json, show->h, info.device);
	put_text(json, "calibrated", info.calibrated);
	json_double(json, "min", info.min);
	json_double(json, "max", info.max);
	put_limits(json, &info);
	put_all(json, &look);
	put_text(json, "alarm", show_alarm(show, signal, words));
	if (show_commanded(show, signal, &look))
		put_number(json, "commanded", &look);
	json_object_end(json);
}

void show_row(struct json *json, const struct show *show, int signal)
{
	char words[SHOW_ALARM];
	const char *alarm = show_alarm(show, signal, words), *why;
	struct face_value look;

	face_value(show->h, signal, show->live, show->now_ns, &look);
	why = face_value_why(&look);
	json_array(json, NULL);
	json_int(json, NULL, signal);
	show_put_value(json, NULL, &look);
	json_int(json, NULL, look.v.quality);
	json_bool(json, NULL, look.good);
	put_age(json, NULL, &look);
	if (*alarm || *why)
		put_text(json, NULL, alarm);
	if (*why)
		put_text(json, NULL, why);
	if (show_commanded(show, signal, &look)) /* it has a reason */
		put_number(json, NULL, &look);
	json_array_end(json);
}

int64_t show_wall_ms(int64_t boot_ns)
{
	struct when now = when_now();

	return boot_ns ? (now.wall - (now.boot - boot_ns)) / NS_PER_MS : 0;
}

/* --- The addresses of Modbus ----------------------------------------------------------------- */

const struct map *places_of(const char *instance)
{
	char path[MAP_PATH];

	return map_path_found(instance, path) ? NULL : places_at(path);
}

const struct map *places_at(const char *path)
{
	static struct map map;
	static struct stat was;
	static bool right;
	struct stat is;
	unsigned line;

	if (stat(path, &is))
		return NULL;
	if (is.st_ino == was.st_ino && is.st_mtim.tv_sec == was.st_mtim.tv_sec &&
	    is.st_mtim.tv_nsec == was.st_mtim.tv_nsec)
		return right ? &map : NULL;
	was = is;
	map_free(&map);
	right = !map_read(&map, path, &line);
	return right ? &map : NULL;
}

int places_register(const struct map *map, const char *identity)
{
	unsigned place = map ? map_known(map, identity) : 0;

	return place ? (int)(place * LAYOUT_RECORD) : -1;
}
