/* SPDX-License-Identifier: MIT */
/* Present alarms, targets, counters, the log, special signals; this machine, and the others. */
#include <microhttpd.h>
#include <stdio.h>

#include "src/faces/kit/look.h"
#include "src/faces/show/json.h"
#include "src/faces/show/names.h"
#include "src/faces/show/present.h"
#include "src/faces/show/stats.h"
#include "src/faces/web/http.h"
#include "src/faces/web/others.h"
#include "src/faces/web/paths.h"
#include "src/faces/web/show.h"
#include "src/faces/web/summary.h"
#include "src/ground/signal/value.h"

#define LINES 256 /* of the log, if owsd keeps so many */

struct listing {
	struct json *json;
	struct show show;
	struct when now;
};

static void lists_add(void *ctx, const struct present *alarm)
{
	struct listing *list = ctx;
	char words[SHOW_ALARM];

	json_object(list->json, NULL);
	json_int(list->json, "i", alarm->signal);
	present_json(list->json, alarm, &list->now);
	json_string(list->json, "words", show_alarm(&list->show, alarm->signal, words));
	show_value(list->json, &list->show, alarm->signal);
	json_object_end(list->json);
}

void lists_alarms(struct json *json, const struct request *request)
{
	static struct reading reading;
	const struct web *web = request->web;
	struct listing list = {.json = json, .now = when_now()};

	list.show = (struct show){
		.h = web->face->ows, .now_ns = list.now.boot, .live = true, .ids = web->ids};
	json_array(json, "alarms");
	for (int i = 0; i < web->recent.count; i++)
		if (web->ids[i] >= 0)
			present_each(web->face->ows, i, web->ids[i], list.now.boot, &reading,
			             lists_add, &list);
	json_array_end(json);
}

void lists_stats(struct json *json, const struct request *request)
{
	const struct face *face = request->web->face;
	const struct when now = when_now();
	struct ows_daemon daemon = {0};

	ows_daemon(face->ows, now.boot, &daemon);
	stats_json(json, face->arguments->instance, face->ows, &daemon, &now);
}

void lists_log(struct json *json, const struct request *request)
{
	static const char *const levels[] = {"error",  "error", "error", "error", "warning",
	                                     "notice", "info",  "debug", "trace"};
	struct ows *ows = request->web->face->ows;
	uint32_t last = ows_log_last(ows);
	struct ows_log_line line;

	json_array(json, "lines");
	/* counted down: the last may be the greatest number that there is */
	for (uint32_t left = last > LINES ? LINES : last; left > 0; left--) {
		if (ows_log_line(ows, last - left + 1, &line))
			continue;
		json_object(json, NULL);
		json_uint(json, "number", line.number);
		json_int(json, "time", show_wall_ms(line.time_ns));
		json_string(json, "level", levels[line.level < 8 ? line.level : 8]);
		json_string(json, "text", line.text);
		json_object_end(json);
	}
	json_array_end(json);
}

/* --- The special signals of a signal --------------------------------------------------------- */

/* The value itself is elsewhere; to read _Alarm would take it from other requests. */
static bool is_shown(enum attribute attribute)
{
	return !attribute_table[attribute].driver && attribute != ATTR_VALUE &&
	       attribute != ATTR_ALARM;
}

static void put_one(struct json *json, struct ows *h, const char *signal,
                    const struct attribute_def *def)
{
	char name[NAMES_MAX], text[VALUE_TEXT_MAX];
	struct ows_value value = {0};
	int id, err;

	snprintf(name, sizeof(name), "%s%s", signal, def->name);
	id = ows_find(h, name);
	err = id < 0 ? id : ows_get_text(h, id, ows_now(), &value, text, sizeof(text));
	json_object(json, NULL);
	json_string(json, "name", def->name);
	json_bool(json, "flag", def->type == OWS_BOOL);
	json_bool(json, "readable", def->readable);
	json_bool(json, "writable", def->writable);
	json_string(json, "value", err ? NULL : text);
	json_object_end(json);
}

int special_get(struct request *request)
{
	const struct face *face = request->web->face;
	const char *name = http_argument(request, "name");
	struct ows_info info;
	struct json json;
	char *text;
	size_t len;

	if (!name || !names_info(face->ows, face->arguments->instance, name, &info))
		return http_error(request, 404, "expected name=: that of a signal");
	if (!json_start(&json, &text, &len))
		return MHD_NO;
	json_array(&json, "signals");
	for (int i = 0; i < ATTR_COUNT; i++)
		if (is_shown((enum attribute)i))
			put_one(&json, face->ows, info.name, &attribute_table[i]);
	json_array_end(&json);
	json_finish(&json);
	return http_json(request, 200, text, len);
}

/* --- Machines -------------------------------------------------------------------------------- */

void machines_summary(struct json *json, const struct request *request)
{
	const struct web *web = request->web;
	const struct face *face = web->face;
	struct summary summary;

	summary_make(&summary, face->arguments->instance, face->ows,
	             face->live && look_is_current(face), web->ids, ows_now());
	summary_json(json, &summary);
}

void machines_others(struct json *json, const struct request *request)
{
	json_array(json, "others");
	others_json(request->web->others, json, ows_now());
	json_array_end(json);
}
