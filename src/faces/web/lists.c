/* SPDX-License-Identifier: MIT */
/* Present alarms, targets, counters, and the log. */
#include <microhttpd.h>

#include "src/faces/kit/look.h"
#include "src/faces/show/present.h"
#include "src/faces/show/stats.h"
#include "src/faces/web/http.h"
#include "src/faces/web/paths.h"
#include "src/faces/web/show.h"

#define LINES 256 /* of the log, if owsd keeps so many */

struct listing {
	struct json json;
	struct show show;
	struct when now;
};

/* False after answering: there is nothing to show. */
static bool lists_begin(struct request *request, struct listing *list, int *result)
{
	const struct web *web = request->web;

	if (!look_is_current(web->face)) {
		*result = http_error(request, 503, "owsd %s is not running: start it",
		                     web->face->arguments->instance);
		return false;
	}
	list->now = when_now();
	list->show = (struct show){
		.h = web->face->ows, .now_ns = list->now.boot, .live = true, .ids = web->ids};
	return true;
}

static void lists_add(void *ctx, const struct present *alarm)
{
	struct listing *list = ctx;

	json_object(&list->json, NULL);
	json_int(&list->json, "i", alarm->signal);
	present_json(&list->json, alarm, &list->now);
	show_value(&list->json, &list->show, alarm->signal);
	json_object_end(&list->json);
}

int lists_alarms(struct request *request)
{
	static struct reading reading;
	const struct web *web = request->web;
	struct listing list;
	char *text;
	size_t len;
	int result;

	if (!lists_begin(request, &list, &result))
		return result;
	if (!json_start(&list.json, &text, &len))
		return MHD_NO;
	json_array(&list.json, "alarms");
	for (int i = 0; i < web->recent.count; i++)
		if (web->ids[i] >= 0)
			present_each(web->face->ows, i, web->ids[i], list.now.boot, &reading,
			             lists_add, &list);
	json_array_end(&list.json);
	json_finish(&list.json);
	return http_json(request, 200, text, len);
}

int lists_stats(struct request *request)
{
	const struct web *web = request->web;
	struct ows_daemon daemon = {0};
	struct listing list;
	char *text;
	size_t len;
	FILE *out;
	int result;

	if (!lists_begin(request, &list, &result))
		return result;
	out = open_memstream(&text, &len);
	if (!out)
		return MHD_NO;
	json_open(&list.json, out);
	ows_daemon(web->face->ows, list.now.boot, &daemon);
	stats_json(&list.json, web->face->arguments->instance, web->face->ows, &daemon, &list.now);
	json_end(&list.json);
	fclose(out);
	return http_json(request, 200, text, len);
}

int lists_log(struct request *request)
{
	static const char *const levels[] = {"error",  "error", "error", "error", "warning",
	                                     "notice", "info",  "debug", "trace"};
	const struct web *web = request->web;
	struct ows_log_line line;
	uint32_t last;
	struct json json;
	char *text;
	size_t len;

	/* also of an owsd that has ended: why it did stands there */
	if (!web->face->ows)
		return http_error(request, 503, "owsd %s has not run yet: start it",
		                  web->face->arguments->instance);
	if (!json_start(&json, &text, &len))
		return MHD_NO;
	json_array(&json, "lines");
	last = ows_log_last(web->face->ows);
	/* counted down: the last may be the greatest number that there is */
	for (uint32_t left = last > LINES ? LINES : last; left > 0; left--) {
		if (ows_log_line(web->face->ows, last - left + 1, &line))
			continue;
		json_object(&json, NULL);
		json_uint(&json, "number", line.number);
		json_int(&json, "time", show_wall_ms(line.time_ns));
		json_string(&json, "level", levels[line.level < 8 ? line.level : 8]);
		json_string(&json, "text", line.text);
		json_object_end(&json);
	}
	json_array_end(&json);
	json_finish(&json);
	return http_json(request, 200, text, len);
}
