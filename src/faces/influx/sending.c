/* SPDX-License-Identifier: MIT */
/* Makes batches, sends them, and does what the answer of the server asks for. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "hal/base/time.h"
#include "src/faces/influx/post.h"
#include "src/faces/influx/sending.h"
#include "src/faces/kit/face.h"

/* A server that answers sooner costs no file, whatever Every is */
#define ANSWER_NS NS_PER_S
#define UNREAD_NS (10 * NS_PER_S)

void sending_read_token(struct face *face)
{
	struct pushing *p = face->own;
	char why[SECRET_PATH + 128];

	secret_read(*p->options.token_file ? p->options.token_file : NULL, p->token, why,
	            sizeof(why));
	if (secret_is_news(why, &p->token_print))
		log_err(face->log, "without a token: %s", why);
}

/* Once when it begins, once when it is over. */
void sending_report_disk(struct face *face, int err)
{
	struct pushing *p = face->own;

	if (err && err != p->disk_err)
		log_err(face->log, "%s cannot be written: %s%s; what waits is in memory alone",
		        p->options.spool, strerror(-err),
		        err == -EBUSY ? "; another owsd-influx writes there: end it, or give one "
		                        "of the two another Spool"
		                      : "");
	if (!err && p->disk_err)
		log_notice(face->log, "%s is written again", p->options.spool);
	p->disk_err = err;
}

static bool put(struct face *face, const char *lines, size_t len)
{
	struct pushing *p = face->own;
	int err;

	err = spool_put(&p->spool, lines, len);
	/* the directory has gone, or was never there: it is opened again */
	if (err == -ENOENT)
		spool_close(&p->spool);
	if (err != -EBADF)
		sending_report_disk(face, err);
	return !err;
}

bool sending_put_away(struct face *face)
{
	struct pushing *p = face->own;

	if (!put(face, p->batch, p->batch_len))
		return false;
	p->batch_len = 0;
	return true;
}

/* The server does not answer in time: what is under way, and what has come since, may be lost. */
static void put_behind(struct face *face)
{
	struct pushing *p = face->own;
	unsigned lines;
	size_t len;

	if (!p->spooled && !spool_count(&p->spool) && put(face, p->batch, p->batch_len))
		p->spooled = spool_oldest(&p->spool);
	len = p->spooled ? pending_copy(&p->pending, p->clock.offset_ns, p->later, &lines) : 0;
	if (len && put(face, p->later, len))
		pending_remove(&p->pending, lines);
}

void sending_cut(struct pushing *p)
{
	p->batch_len = pending_cut(&p->pending, p->clock.offset_ns, p->batch);
	p->spooled = 0;
}

/* Is the batch the oldest of the spool still? A full one may have dropped it. */
static bool is_oldest(const struct pushing *p)
{
	return p->spooled && p->spooled == spool_oldest(&p->spool);
}

void sending_drop(struct pushing *p)
{
	part_begin(&p->part);
	p->batch_len = 0;
}

static const char *advice_on_status(long status)
{
	return status == 401       ? "TokenFile has to have its token"
	       : status == 403     ? "its token may not write there"
	       : status == 404     ? "it has no such path or database: correct Url"
	       : status / 100 == 3 ? "it is elsewhere: correct Url"
	                           : "correct Url";
}

/* A proxy whose server is away answers with 502 or 504. */
static enum backoff_why why_of(const struct post_result *result)
{
	return result->status && result->status != 502 && result->status != 504 ? BACKOFF_REFUSED
	                                                                        : BACKOFF_AWAY;
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
	p->next_ns = now_ns + backoff_pause(&p->backoff, why_of(result), backoff_random());
	part_begin(&p->part);
	if (p->spooled)
		p->batch_len = 0;
	else
		sending_put_away(face);
}

/* The server has understood what it got. */
static void server_answered(struct face *face)
{
	struct pushing *p = face->own;

	if (p->trouble != PUSH_WELL)
		log_notice(face->log, "%.100s is back; %zu batches wait", p->options.url,
		           spool_count(&p->spool) - is_oldest(p));
	p->trouble = PUSH_WELL;
	backoff_forget(&p->backoff);
}

/* The part is done with; after the last one the batch is. */
static void part_over(struct pushing *p)
{
	part_taken(&p->part);
	if (p->part.at < p->batch_len)
		return;
	if (is_oldest(p))
		spool_remove(&p->spool);
	sending_drop(p);
}

static void batch_arrived(struct face *face)
{
	struct pushing *p = face->own;

	server_answered(face);
	p->refused = false;
	p->sent += batch_lines(p->batch + p->part.at, p->part.len);
	part_over(p);
}

/* The server does not want these lines: others may be better. */
static void batch_refused(struct face *face, const struct post_result *result)
{
	struct pushing *p = face->own;

	server_answered(face);
	if (!p->refused)
		log_err(face->log, "%.100s refuses lines: %s; the spool has them as *.refused",
		        p->options.url, result->words);
	p->refused = true;
	p->refused_batches++;
	if (p->part.len < p->batch_len) {
		spool_refuse(&p->spool, p->batch + p->part.at, p->part.len);
		part_over(p);
		return;
	}
	spool_refuse(&p->spool, is_oldest(p) ? NULL : p->batch, p->batch_len);
	sending_drop(p);
}

/* The same lines in smaller parts; a line that is too large alone is refused. */
static void batch_too_large(struct face *face, const struct post_result *result)
{
	struct pushing *p = face->own;

	if (!part_halve(&p->part, p->batch)) {
		batch_refused(face, result);
		return;
	}
	server_answered(face);
	log_notice(face->log, "%.100s takes less at once: %s; parts of %zu bytes follow",
	           p->options.url, result->words, p->part.most);
}

void sending_finished(struct face *face, const struct post_result *result, int64_t now_ns)
{
	log_debug(face->log, "%s", result->words);
	if (result->status >= 200 && result->status < 300)
		batch_arrived(face);
	else if (result->status == 413)
		batch_too_large(face, result);
	else if (result->status == 400 || result->status == 422)
		batch_refused(face, result);
	else
		sending_fail(face, result, now_ns);
}

/* The oldest file as the batch. One that cannot be read is left out. */
static void take_spooled(struct face *face, int64_t now_ns)
{
	char name[SPOOL_NAME], others[LOG_OTHERS];
	struct pushing *p = face->own;
	int64_t len = spool_read(&p->spool, p->batch, sizeof(p->batch));
	uint64_t unread;
	bool later;

	if (len > 0) {
		p->batch_len = (size_t)len;
		p->spooled = spool_oldest(&p->spool);
		return;
	}
	/* What the disk, or this process, cannot do now it may do later. */
	later = len && len != -EFBIG && len != -ENOENT && len != -ELOOP;
	spool_name(&p->spool, name);
	unread = log_rate(&p->unread, now_ns);
	if (unread)
		log_err(face->log, "%s/%s %s: %s%s", p->options.spool, name,
		        later ? "cannot be read yet" : "is passed over",
		        len ? strerror((int)-len) : "it is empty", log_others(unread, others));
	if (later) {
		p->next_ns = now_ns + UNREAD_NS;
		return;
	}
	spool_refuse(&p->spool, NULL, 0);
}

/* Make a batch and send one, if it is time to. */
void sending_advance(struct face *face, int64_t now_ns)
{
	struct pushing *p = face->own;
	bool busy = post_is_busy(p->post), waits = p->pending.lines || (busy && !p->spooled);
	bool due = waits && (now_ns >= p->cut_ns || pending_is_full(&p->pending));

	if (!p->on || !p->believed)
		return;
	if (due && busy && now_ns >= p->begun_ns + ANSWER_NS) {
		p->cut_ns = now_ns + p->options.every_ns;
		put_behind(face);
	} else if (due && !p->batch_len) {
		p->cut_ns = now_ns + p->options.every_ns;
		sending_cut(p);
		/* nothing overtakes what waits */
		if (spool_count(&p->spool) || now_ns < p->next_ns)
			sending_put_away(face);
	}
	if (busy || now_ns < p->next_ns)
		return;
	if (!p->batch_len && spool_count(&p->spool))
		take_spooled(face, now_ns);
	if (!p->batch_len)
		return;
	if (p->trouble == PUSH_DENIED)
		sending_read_token(face);
	part_next(&p->part, p->batch, p->batch_len);
	p->begun_ns = now_ns;
	if (post_begin(p->post, p->options.url, p->token, p->batch + p->part.at, p->part.len))
		sending_fail(face, &(struct post_result){.words = "no memory"}, now_ns);
}
