/* SPDX-License-Identifier: MIT */
/* What is behind the paths: the instance, and its signals. */
#include <microhttpd.h>
#include <string.h>
#include <sys/utsname.h>

#include "hal/base/time.h"
#include "src/faces/kit/look.h"
#include "src/faces/show/json.h"
#include "src/faces/show/metrics.h"
#include "src/faces/show/stats.h"
#include "src/faces/web/draft.h"
#include "src/faces/web/events.h"
#include "src/faces/web/http.h"
#include "src/faces/web/others.h"
#include "src/faces/web/paths.h"
#include "src/faces/web/show.h"
#include "src/faces/web/stream.h"
#include "src/ground/board/files.h"

#define PIECE 20             /* signals that are written at a time */
#define PIECE_OF_METRICS 100 /* samples */

/* The model of the board, where the firmware names it, and the kernel. */
static void put_machine(struct json *json)
{
	char board[120], kernel[200] = "";
	struct utsname system;

	board_text("", "/proc/device-tree/model", board, sizeof(board));
	if (uname(&system) == 0)
		snprintf(kernel, sizeof(kernel), "%s %s %s", system.sysname, system.release,
		         system.machine);
	json_string(json, "board", *board ? board : NULL);
	json_string(json, "kernel", *kernel ? kernel : NULL);
}

static void put_info(struct json *json, const struct request *request)
{
	const struct web *web = request->web;
	char person[PERSON] = "";
	struct ows_daemon daemon = {0};
	struct ows_log_line refused;
	const char *why;
	bool writable;
	int64_t now_ns = ows_now();

	if (web->face->live)
		ows_daemon(web->face->ows, now_ns, &daemon);
	stats_whose(json, web->face->arguments->instance);
	json_string(json, "version", OWSD_VERSION);
	put_machine(json);
	json_bool(json, "live", web->face->live);
	json_uint(json, "generation", web->generation);
	if (web->face->live)
		json_seconds(json, "up", now_ns - daemon.start_ns);
	else
		json_null(json, "up");
	json_string(json, "refused",
	            web->face->live && ows_refused_reload(web->face->ows, &refused) == 0
	                    ? refused.text
	                    : NULL);
	json_int(json, "now", show_wall_ms(now_ns));
	json_int(json, "since", web->since_ns / NS_PER_MS);
	writable = http_may(request, PERSON_WRITE, person, &why);
	json_bool(json, "writable", writable);
	json_bool(json, "configurable", http_may(request, PERSON_CONFIGURE, person, &why));
	json_string(json, "person", *person ? person : NULL);
	json_bool(json, "history",
	          past_is_there(web->face->arguments->instance, web->face->config));
	json_int(json, "signals", web->recent.count);
	json_uint(json, "others", others_count(web->others));
}

/* --- Metrics --------------------------------------------------------------------------------- */

static enum stream_more put_metrics(struct stream *stream, FILE *out)
{
	const struct web *web = stream->web;
	const struct metrics metrics = {.instance = web->face->arguments->instance,
	                                .h = web->face->ows,
	                                .lost = !web->face->live};

	if (stream->position.generation != web->generation)
		return STREAM_BROKEN;
	return metrics_print(out, &metrics, &stream->row, PIECE_OF_METRICS) ? STREAM_MORE
	                                                                    : STREAM_END;
}

static int answer_metrics(struct request *request)
{
	const struct web *web = request->web;
	struct stream stream = {.fill = put_metrics, .position.generation = web->generation};

	return stream_answer(request, METRICS_TYPE, &stream);
}

/* --- Signals --------------------------------------------------------------------------------- */

static enum stream_more put_signals(struct stream *stream, FILE *out)
{
	const struct web *web = stream->web;
	struct show show = {.h = web->face->ows,
	                    .now_ns = ows_now(),
	                    .live = web->face->live,
	                    .ids = web->ids,
	                    .places = places_of(web->face->arguments->instance)};
	struct json json = {.out = out, .inner = stream->row > 0};
	struct ows_daemon daemon;

	/* indexes of signals mean others now: the client has to ask again */
	if (stream->position.generation != web->generation ||
	    (web->face->live && !look_is_current(web->face)))
		return STREAM_BROKEN;
	if (!stream->begun) {
		stream->begun = true;
		json_object(&json, NULL);
		json_uint(&json, "generation", web->generation);
		json_uint(&json, "cursor", web->recent.newest);
		json_int(&json, "now", show_wall_ms(show.now_ns));
		json_array(&json, "signals");
	}
	if (ows_daemon(web->face->ows, show.now_ns, &daemon) == 0)
		show.start_ns = daemon.start_ns;
	for (int i = 0; i < PIECE && stream->row < web->recent.count; i++)
		show_signal(&json, &show, stream->row++);
	if (stream->row < web->recent.count)
		return STREAM_MORE;
	json_array_end(&json);
	json_object_end(&json);
	json_end(&json);
	return STREAM_END;
}

static int answer_signals(struct request *request)
{
	const struct web *web = request->web;
	struct stream stream = {.fill = put_signals, .position.generation = web->generation};

	if (web->face->live && !look_is_current(web->face))
		return http_error(request, 503, "owsd %s reloads its file: ask again in a second",
		                  web->face->arguments->instance);
	return stream_answer(request, "application/json", &stream);
}

/* --- Paths ----------------------------------------------------------------------------------- */

static const struct web_path paths[] = {
	{"api/info", .put = put_info},
	{"api/signals", .need = WEB_IMAGE, .answer = answer_signals},
	{"api/events", .answer = events_answer},
	{"api/alarms", .need = WEB_OWSD, .put = lists_alarms},
	{"api/stats", .need = WEB_OWSD, .put = lists_stats},
	/* also of an owsd that has ended: why it did stands there */
	{"api/log", .need = WEB_IMAGE, .put = lists_log},
	{"api/special", .need = WEB_OWSD, .answer = special_get},
	{"api/journal", .answer = past_journal},
	{"api/trend", .answer = past_trend},
	{"api/hour", .answer = past_hour},
	{"api/records", .answer = past_records},
	{"api/set", .post = true, .deed = PERSON_WRITE, .answer = command_set},
	{"api/alarm", .post = true, .deed = PERSON_WRITE, .answer = command_alarm},
	{"api/config", .answer = stored_get},
	{"api/config/keys", .put = stored_keys},
	{"api/config/draft", .post = true, .deed = PERSON_CONFIGURE, .answer = draft_post},
	{"api/config/save", .post = true, .deed = PERSON_CONFIGURE, .answer = save_post},
	{"api/config/restore", .post = true, .deed = PERSON_CONFIGURE, .answer = save_restore},
	{"api/summary", .put = machines_summary},
	{"api/others", .put = machines_others},
	/* it loads the wire */
	{"api/devices", .deed = PERSON_CONFIGURE, .answer = devices_get},
	{"metrics", .need = WEB_IMAGE, .answer = answer_metrics},
};

const struct web_path *api_find(const char *path, bool post)
{
	for (size_t i = 0; i < sizeof(paths) / sizeof(paths[0]); i++)
		if (paths[i].post == post && strcmp(paths[i].path, path) == 0)
			return &paths[i];
	return NULL;
}
