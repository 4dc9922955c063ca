/* SPDX-License-Identifier: MIT */
/* Server-Sent Events. */
#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "hal/base/time.h"
#include "src/faces/kit/look.h"
#include "src/faces/show/journal_entry.h"
#include "src/faces/web/events.h"
#include "src/faces/web/show.h"
#include "src/faces/web/stream.h"

#define PIECE 200 /* rows that are written at a time */

static int64_t wall_ms(void)
{
	return show_wall_ms(ows_now());
}

static void put_id(const struct position *at, FILE *out)
{
	fprintf(out, "id: %" PRIu32 ":%" PRIu64 "\n", at->generation, at->seen);
}

static void events_begin(FILE *out, const char *event, struct json *json)
{
	fprintf(out, "event: %s\ndata: ", event);
	json_open(json, out);
	json_object(json, NULL);
	json_int(json, "now", wall_ms());
}

/* The newest state is what the client asks for next. */
static void put_found(struct stream *stream, FILE *out)
{
	const struct web *web = stream->web;
	struct json json;

	stream->position.generation = web->generation;
	stream->position.seen = stream->alarms_seen = web->recent.newest;
	stream->begun = true;
	stream->told_lost = false;
	stream->refused_seen = web->refused;
	put_id(&stream->position, out);
	events_begin(out, "found", &json);
	json_uint(&json, "generation", web->generation);
	json_object_end(&json);
	fputs("\n\n", out);
}

static void put_lost(struct stream *stream, FILE *out)
{
	struct json json;

	stream->told_lost = true;
	events_begin(out, "lost", &json);
	json_string(&json, "why", "owsd is not running: no value is known until it is started");
	json_object_end(&json);
	fputs("\n\n", out);
}

/* The client has to look at all. */
static void put_missed(FILE *out)
{
	struct json json;

	events_begin(out, "missed", &json);
	json_object_end(&json);
	fputs("\n\n", out);
}

static bool put_alarms(struct stream *stream, FILE *out)
{
	const struct web *web = stream->web;
	bool some = stream->alarms_seen < web->alarms_lost;

	if (some) {
		/* alarms came that this stream does not get any more */
		stream->alarms_seen = web->alarms_lost;
		put_missed(out);
	}
	for (unsigned i = 0; i < WEB_ALARMS; i++) {
		unsigned at = (web->next_alarm + i) % WEB_ALARMS;

		if (web->alarms[at].cursor <= stream->alarms_seen || !web->alarms[at].text)
			continue;
		stream->alarms_seen = web->alarms[at].cursor;
		fprintf(out, "event: alarm\ndata: %s\n", web->alarms[at].text);
		some = true;
	}
	return some;
}

/* Rows up to at->until, a piece at a time, as one event whose id comes at its end. */
static void make_piece(const struct web *web, struct position *at, FILE *out)
{
	struct show show = {
		.h = web->face->ows, .now_ns = ows_now(), .live = true, .ids = web->ids};
	bool same = at->generation == web->generation && look_is_current(web->face);
	int row = same ? recent_after(&web->recent, at->seen) : -1;
	struct json json = {.out = out};

	if (!at->within) {
		events_begin(out, "values", &json);
		fputs(",\"v\":[", out);
	}
	json = (struct json){.out = out, .inner = at->some};
	for (int i = 0; i < PIECE && row >= 0 && web->recent.of[row].cursor <= at->until; i++) {
		show_row(&json, &show, row);
		at->seen = web->recent.of[row].cursor;
		at->some = true;
		row = web->recent.of[row].newer;
	}
	at->within = row >= 0 && web->recent.of[row].cursor <= at->until;
	if (at->within)
		return;
	if (same)
		at->seen = at->until;
	at->some = false;
	fputs("]}\n", out);
	put_id(at, out);
	putc('\n', out);
}

/* As another stream got it, or made. */
static void put_piece(struct stream *stream, FILE *out)
{
	struct web *web = stream->web;
	struct position from = stream->position;
	int64_t now_ns = ows_now();
	char *made = NULL;
	size_t len = 0;
	const char *text = shared_find(&web->shared, &stream->position, now_ns, &len);
	FILE *piece = text ? NULL : open_memstream(&made, &len);

	if (piece) {
		make_piece(web, &stream->position, piece);
		if (fclose(piece) == 0)
			shared_keep(&web->shared, &from, &stream->position, now_ns, made, len);
		text = made;
	}
	if (text)
		fwrite(text, 1, len, out);
	free(made);
}

static bool may_go_out(const struct web *web, const struct stream *stream)
{
	int row = look_is_current(web->face) ? recent_after(&web->recent, stream->position.seen)
	                                     : -1;

	return row >= 0 && web->recent.of[row].cursor <= web->pace.sent;
}

static bool put_next(struct stream *stream, FILE *out)
{
	const struct web *web = stream->web;

	if (stream->position.within) {
		put_piece(stream, out);
		return true;
	}
	if (!web->face->live) {
		if (!stream->told_lost)
			put_lost(stream, out);
		return ftell(out) > 0;
	}
	if (!stream->begun || stream->told_lost || stream->position.generation != web->generation) {
		put_found(stream, out);
		return true;
	}
	if (put_alarms(stream, out))
		return true;
	if (stream->refused_seen != web->refused) {
		stream->refused_seen = web->refused;
		put_missed(out);
		return true;
	}
	if (!may_go_out(web, stream))
		return false;
	stream->position.until = web->pace.sent;
	put_piece(stream, out);
	return true;
}

static enum stream_more events_fill(struct stream *stream, FILE *out)
{
	int64_t now_ns = ows_now();

	if (put_next(stream, out)) {
		stream->written_ns = now_ns;
		return STREAM_MORE;
	}
	/* a client that has gone is only noticed when something is written */
	if (now_ns - stream->written_ns < EVENTS_ALIVE_S * NS_PER_S)
		return STREAM_SLEEP;
	stream->written_ns = now_ns;
	fputs("event: alive\ndata: {}\n\n", out);
	return STREAM_MORE;
}

/* GENERATION:CURSOR of a client that comes back. False: it is none. */
static bool take_id(const char *id, struct stream *stream)
{
	unsigned long long generation, cursor;
	char *end;

	if (!id || *id < '0' || *id > '9')
		return false;
	generation = strtoull(id, &end, 10);
	if (generation > UINT32_MAX || *end != ':' || end[1] < '0' || end[1] > '9')
		return false;
	errno = 0;
	cursor = strtoull(end + 1, &end, 10);
	stream->position.generation = (uint32_t)generation;
	stream->position.seen = cursor;
	return !*end && !errno;
}

int events_answer(struct request *request)
{
	const struct web *web = request->web;
	struct stream stream = {.fill = events_fill};

	stream.written_ns = ows_now() - EVENTS_ALIVE_S * NS_PER_S;
	/* a browser that comes back by itself has the header, and still asks for after */
	if (take_id(http_header(request, "Last-Event-ID"), &stream) ||
	    take_id(http_argument(request, "after"), &stream))
		stream.begun = stream.position.generation == web->generation &&
		               stream.position.seen && stream.position.seen <= web->recent.newest;
	stream.alarms_seen = stream.position.seen;
	return stream_answer(request, "text/event-stream; charset=utf-8", &stream);
}

void events_alarm(struct web *web, const struct ows_alarm *alarm)
{
	struct show show = {
		.h = web->face->ows, .now_ns = ows_now(), .live = web->face->live, .ids = web->ids};
	unsigned at = web->next_alarm++ % WEB_ALARMS;
	struct journal_entry entry = {
		.when_ns = alarm->occurred_ns,
		.signal = alarm->signal,
		.this_boot = true,
		.alarm = *alarm,
	};
	struct when now = when_now();
	char words[SHOW_ALARM];
	struct ows_info info;
	struct json json;
	size_t len;

	if (web->alarms[at].text)
		web->alarms_lost = web->alarms[at].cursor;
	free(web->alarms[at].text);
	web->alarms[at].text = NULL;
	if (ows_info(web->face->ows, alarm->signal, &info) ||
	    !json_start(&json, &web->alarms[at].text, &len)) {
		events_miss_alarms(web);
		return;
	}
	entry.name = info.name;
	json_int(&json, "now", wall_ms());
	json_int(&json, "i", alarm->signal);
	json_string(&json, "alarm", show_alarm(&show, alarm->signal, words));
	json_key(&json, "entry");
	journal_json(&json, &now, &entry, true);
	json_finish(&json);
	web->alarms[at].cursor = recent_next(&web->recent, show.now_ns);
}

void events_miss_alarms(struct web *web)
{
	web->alarms_lost = recent_next(&web->recent, ows_now());
}

void events_forget_alarms(struct web *web)
{
	for (unsigned i = 0; i < WEB_ALARMS; i++)
		free(web->alarms[i].text);
}
