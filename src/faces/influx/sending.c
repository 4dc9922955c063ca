/* SPDX-License-Identifier: MIT */
/* Makes batches, sends them, and does what the answer of the server asks for. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/base/time.h"
#include "src/faces/influx/sending.h"
#include "src/faces/kit/face.h"
#include "src/faces/kit/look.h"
#include "src/faces/kit/post.h"
#include "src/ground/text/influx.h"

#define ROWS 500 /* of the history at a time */

void sending_read_token(struct face *face)
{
	struct pushing *p = face->own;
	char why[SECRET_PATH + 128];

	secret_read(*p->options.token_file ? p->options.token_file : NULL, p->token, why,
	            sizeof(why));
	if (secret_is_news(why, &p->token_print))
		log_err(face->log, "without a token: %s", why);
}

/* --- What the server has missed -------------------------------------------------------------- */

void sending_look_at_dropped(struct face *face)
{
	struct pushing *p = face->own;

	if (p->pending.dropped == p->lost_lines)
		return;
	log_warning(face->log, "too much waits in memory: %llu values are dropped%s",
	            (unsigned long long)(p->pending.dropped - p->lost_lines),
	            p->missed.there ? ", and will come from the history" : "");
	p->lost_lines = p->pending.dropped;
	if (p->pending.dropped_ns > p->missed_ns)
		p->missed_ns = p->pending.dropped_ns + 1;
	p->rows_end = 0; /* they are read once more */
}

/* A row of the history as a line; a gap of all is one of each signal, with its quality alone. */
static void add_row(struct pushing *p, const struct replay_row *row)
{
	bool gap = row->signal == -1;
	int first = gap ? 0 : row->signal, end = gap ? p->points.count : row->signal + 1;
	bool earlier = row->at.boot != p->missed.boot;
	struct ows_value v = row->v;
	char fields[INFLUX_FIELDS + 16];

	if (gap)
		v = (struct ows_value){.quality = OWS_Q_STALE};
	points_fields(&v, row->text ? row->text : "", fields, sizeof(fields));
	for (int i = first; i >= 0 && i < end; i++) {
		const char *series = p->points.rows[i].series;

		if (series && earlier)
			pending_add_dated(&p->pending, row->wall_us * 1000, series, fields);
		else if (series)
			pending_add(&p->pending, row->at.us * 1000, series, fields);
	}
}

static void take_rows(struct face *face, int64_t now_ns)
{
	struct pushing *p = face->own;
	struct replay_row rows[ROWS];
	int n = 0;

	if (!p->rows_end && !p->missed_ns && p->pending.lines < BATCH_LINES / 2 &&
	    missed_look(&p->missed, now_ns))
		n = missed_read(&p->missed, p->points.count, rows, ROWS, now_ns);
	for (int i = 0; i < n; i++) {
		add_row(p, &rows[i]);
		free(rows[i].text);
	}
	if (!n)
		return;
	p->rows = n;
	p->at = rows[n - 1].at;
	p->rows_end = p->pending.first + p->pending.lines;
	p->cut_ns = now_ns;
}

/* --- The answer ------------------------------------------------------------------------------ */

static const char *advice_on_status(long status)
{
	return status == 401       ? "TokenFile has to have its token"
	       : status == 403     ? "its token may not write there"
	       : status == 404     ? "it has no such path or database: correct Url"
	       : status / 100 == 3 ? "it is elsewhere: correct Url"
	                           : "correct Url";
}

/* Once when it is lost, once more when the reason is of another kind. */
static void sending_fail(struct face *face, const struct post_result *result, int64_t now_ns)
{
	struct pushing *p = face->own;
	enum push_trouble trouble = PUSH_AWAY;

	if (result->status >= 300 && result->status < 500 && result->status != 408 &&
	    result->status != 425 && result->status != 429)
		trouble = PUSH_DENIED;
	if (trouble != p->trouble && trouble == PUSH_DENIED)
		log_err(face->log, "%.100s refuses us: %s; %s", p->options.url, result->words,
		        advice_on_status(result->status));
	else if (trouble != p->trouble)
		log_warning(face->log, "%.100s is lost: %s; values wait", p->options.url,
		            result->words);
	p->trouble = trouble;
	p->next_ns = now_ns +
	             backoff_pause(&p->backoff, post_why(result->status), backoff_random());
	p->cut_ns = now_ns;
}

/* The server has understood what it got. */
static void server_answered(struct face *face)
{
	struct pushing *p = face->own;

	if (p->trouble != PUSH_WELL)
		log_notice(face->log, "%.100s is back; %u values wait", p->options.url,
		           p->pending.lines);
	p->trouble = PUSH_WELL;
	backoff_forget(&p->backoff);
}

/* The batch is done with, and the server gets what changes. */
static void batch_over(struct face *face, int64_t now_ns)
{
	struct pushing *p = face->own;
	struct replay_point point;

	sending_look_at_dropped(face);
	pending_remove(&p->pending, p->batch_end);
	if (p->missed_ns) {
		point = missed_point(&p->missed, p->missed_ns);
		missed_resume(&p->missed, &point, now_ns);
		p->missed_ns = p->pending.dropped_ns = 0;
	}
	if (p->batch_all) {
		point = missed_point(&p->missed, p->looked_ns);
		missed_has(&p->missed, &point);
	}
	if (p->rows_end && p->pending.first >= p->rows_end) {
		missed_given(&p->missed, &p->at, p->rows, now_ns);
		p->rows_end = 0;
	}
	missed_keep(&p->missed, MISSED_KEEP_NS, now_ns);
}

/* The server does not want these lines: others may be better. */
static void batch_refused(struct face *face, const struct post_result *result, int64_t now_ns)
{
	struct pushing *p = face->own;

	server_answered(face);
	if (!p->refused)
		log_err(face->log, "%.60s refuses %u lines: %s; the first: %.*s", p->options.url,
		        p->batch_lines, result->words, (int)strcspn(p->batch, "\n"), p->batch);
	p->refused = true;
	p->refused_lines += p->batch_lines;
	batch_over(face, now_ns);
}

/*
 * By the status of HTTP: taken; too large (the same lines go in smaller batches, and one line that
 * is too large alone is refused); lines that the server does not want; a server that takes nothing.
 */
void sending_finished(struct face *face, const struct post_result *result, int64_t now_ns)
{
	struct pushing *p = face->own;

	log_debug(face->log, "%s", result->words);
	if (result->status >= 200 && result->status < 300) {
		server_answered(face);
		p->refused = false;
		p->sent += p->batch_lines;
		batch_over(face, now_ns);
	} else if (result->status == 413 && p->batch_lines > 1) {
		server_answered(face);
		p->most = p->batch_len / 2;
		p->cut_ns = now_ns;
		log_notice(face->log, "%.100s takes less at once: %s; %zu bytes follow",
		           p->options.url, result->words, p->most);
	} else if (result->status == 413 || result->status == 400 || result->status == 422) {
		batch_refused(face, result, now_ns);
	} else {
		sending_fail(face, result, now_ns);
	}
}

void sending_advance(struct face *face, bool ending, int64_t now_ns)
{
	struct pushing *p = face->own;

	if (!p->on || !p->believed || post_is_busy(p->post) || now_ns < p->next_ns)
		return;
	if (p->trouble == PUSH_WELL && !ending && look_is_current(face))
		take_rows(face, now_ns);
	if (!p->pending.lines || (!ending && now_ns < p->cut_ns && !pending_is_full(&p->pending)))
		return;
	if (p->trouble == PUSH_DENIED)
		sending_read_token(face);
	p->batch_len = pending_copy(&p->pending, p->clock.offset_ns, p->most, p->batch,
	                            &p->batch_lines);
	p->batch_end = p->pending.first + p->batch_lines;
	p->batch_all = p->batch_lines == p->pending.lines;
	p->looked_ns = face->looked_ns;
	if (p->batch_all)
		p->cut_ns = now_ns + p->options.every_ns;
	if (post_begin(p->post, &(struct post_what){.url = p->options.url,
	                                            .type = "text/plain; charset=utf-8",
	                                            .scheme = "Token",
	                                            .token = p->token,
	                                            .data = p->batch,
	                                            .len = p->batch_len}))
		sending_fail(face, &(struct post_result){.words = "no memory"}, now_ns);
}
