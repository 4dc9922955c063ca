/* SPDX-License-Identifier: MIT */
/*
 * owsd-influx: pushes the signals of an owsd to a server that takes InfluxDB's line protocol. Lines
 * wait in memory, and go as a batch each few seconds; what a server has missed comes from the
 * history of owsd-recorder. One batch at a time is under way.
 */
#include <errno.h>
#include <string.h>

#include "hal/base/time.h"
#include "src/faces/influx/sending.h"
#include "src/faces/kit/look.h"
#include "src/faces/kit/loop.h"
#include "src/faces/kit/post.h"
#include "src/faces/kit/secret.h"

/* Of changes of a signal that come closer together the newest is sent */
#define PACE_NS (20 * NS_PER_MS)
#define TICK_NS NS_PER_S
#define END_NS (5 * NS_PER_S)

/* missed.info */
static bool info_of(void *ctx, int row, struct ows_info *info)
{
	struct face *face = ctx;
	const struct pushing *p = face->own;

	return row < p->points.count && p->points.rows[row].series &&
	       !ows_info(face->ows, row, info);
}

static void pushing_begin(struct face *face, int64_t now_ns)
{
	struct pushing *p = face->own;

	p->on = true;
	p->trouble = PUSH_WELL;
	backoff_forget(&p->backoff);
	p->next_ns = now_ns;
	p->cut_ns = now_ns + p->options.every_ns;
	p->most = BATCH_BYTES;
	sending_read_token(face);
	p->missed = (struct missed){.face = face,
	                            .peer = "the server",
	                            .what = "influx",
	                            .info = info_of,
	                            .ctx = face,
	                            .dated = p->clock.trusted};
	/* one key: what a server could not take goes to the one that another Url names */
	missed_begin(&p->missed, 1, now_ns);
	p->missed_ns = now_ns;
	p->rows_end = 0;
	log_notice(face->log, "pushing to %.100s", p->options.url);
	log_info(face->log, "ClockWait %lld s", (long long)(p->options.clock_wait_ns / NS_PER_S));
}

/* What is in memory goes out, if the server takes it at once; else the history has to have it. */
static void pushing_end(struct face *face)
{
	struct pushing *p = face->own;
	int64_t until_ns = ows_now() + END_NS;
	struct post_result result;

	while (p->on && p->trouble == PUSH_WELL && ows_now() < until_ns) {
		sending_advance(face, true, ows_now());
		if (!post_wait(p->post, until_ns, &result))
			break;
		sending_finished(face, &result, ows_now());
	}
	post_cancel(p->post);
	if (p->on) {
		missed_keep(&p->missed, 0, ows_now());
		missed_drop(&p->missed);
	}
	p->on = false;
}

static void make_points(struct face *face)
{
	struct pushing *p = face->own;

	missed_drop(&p->missed); /* its rows are those of the image */
	if (!p->on || !face->live) {
		points_free(&p->points);
		return;
	}
	if (points_make(&p->points, face->ows, p->options.measurement, face->arguments->instance,
	                &p->pending, ows_now()))
		log_err(face->log, "nothing is sent: no memory for %d signals",
		        ows_count(face->ows));
	if (p->points.left_out)
		log_warning(face->log, "%d signals are not sent: no line can have their names",
		            p->points.left_out);
}

/* The file may say something else than before, or have no block any more. */
static void take_file(struct face *face, int64_t now_ns)
{
	struct pushing *p = face->own;
	struct push_options options;

	push_options_take(&options, face);
	/* NOLINTNEXTLINE(bugprone-suspicious-memory-comparison,cert-exp42-c,cert-flp37-c) */
	if (memcmp(&options, &p->options, sizeof(options)) != 0) {
		pushing_end(face);
		p->options = options;
		if (*options.url)
			pushing_begin(face, now_ns);
	} else if (p->on) {
		sending_read_token(face);
		p->next_ns = now_ns;
	}
	if (!p->on)
		log_notice(face->log, "%s has no Influx block: nothing is pushed",
		           face->arguments->file);
	make_points(face);
}

static int pushing_open(struct face *face)
{
	static struct pushing pushing;
	struct pushing *p = face->own = &pushing;
	int64_t now_ns = ows_now();

	p->post = post_open(face_watch_anew, face);
	if (!p->post) {
		face_complain(face->ops->program, "libcurl cannot be used: no memory");
		return -ENOMEM;
	}
	wall_clock_open(&p->clock);
	face->pace_ns = PACE_NS;
	face->tick_ns = now_ns;
	take_file(face, now_ns);
	return 0;
}

static void pushing_close(struct face *face)
{
	struct pushing *p = face->own;

	pushing_end(face);
	if (p->pending.lines && !p->believed)
		log_err(face->log, "%u values in memory are lost: the time is not known yet",
		        p->pending.lines);
	else if (p->pending.lines)
		log_notice(face->log, "%u values in memory %s", p->pending.lines,
		           p->missed.there ? "will come from the history" : "are lost");
	pending_free(&p->pending);
	post_close(p->post);
	points_free(&p->points);
}

/* Whether lines can have wall-clock times. */
static void believe_clock(struct face *face, int64_t now_ns)
{
	struct pushing *p = face->own;

	wall_clock_look(&p->clock, now_ns);
	p->missed.dated = p->clock.trusted;
	if (p->believed || !p->on)
		return;
	p->believed = p->clock.trusted || now_ns >= p->options.clock_wait_ns;
	if (p->believed && !p->clock.trusted)
		log_warning(face->log,
		            "nobody has set the clock %lld s after the boot: it is "
		            "believed as it is",
		            (long long)(now_ns / NS_PER_S));
}

/* What keeps it from pushing; NULL: nothing does. */
static const char *trouble_of(const struct pushing *p)
{
	return p->trouble == PUSH_AWAY     ? "the server is lost"
	       : p->trouble == PUSH_DENIED ? "the server refuses us"
	       : p->refused                ? "the server refuses lines"
	                                   : NULL;
}

/* What keeps it from pushing. */
static void pushing_report(struct face *face, FILE *out)
{
	const char *trouble = trouble_of(face->own);

	if (trouble)
		fprintf(out,
		        "trouble %s: look at Url and TokenFile of the block Influx, and at its log\n",
		        trouble);
}

static void pushing_status(struct face *face)
{
	struct pushing *p = face->own;
	const char *trouble = trouble_of(p);
	const char *state = !p->on         ? "no Influx block: off"
	                    : !p->believed ? "waiting for the time"
	                    : trouble      ? trouble
	                    : face->live   ? "pushing"
	                                   : "waiting for owsd";

	face_status(face,
	            "%s; %llu values sent, %u in memory, %llu from the history, %llu refused, "
	            "%llu dropped",
	            state, (unsigned long long)p->sent, p->pending.lines,
	            (unsigned long long)p->missed.sent, (unsigned long long)p->refused_lines,
	            (unsigned long long)p->pending.dropped);
}

/* fd is ready; -1: none, but something may be due. */
static void push_on(struct face *face, int fd, short ready)
{
	struct pushing *p = face->own;
	int64_t now_ns = ows_now();
	struct post_result result;

	/* lines get their times here */
	believe_clock(face, now_ns);
	if ((fd >= 0 || now_ns >= post_next(p->post)) && post_step(p->post, fd, ready, &result))
		sending_finished(face, &result, now_ns);
	sending_advance(face, false, now_ns);
	face->tick_ns = now_ns + TICK_NS;
	if (post_next(p->post) < face->tick_ns)
		face->tick_ns = post_next(p->post);
	if (p->on && p->cut_ns > now_ns && p->cut_ns < face->tick_ns)
		face->tick_ns = p->cut_ns;
}

static void pushing_tick(struct face *face, int64_t now_ns)
{
	struct pushing *p = face->own;

	if (p->on && look_is_current(face))
		points_repeat(&p->points, face->ows, &p->pending, now_ns);
	push_on(face, -1, 0);
	sending_look_at_dropped(face);
	pushing_status(face);
}

static void pushing_changes(struct face *face, const int *signals, int n)
{
	struct pushing *p = face->own;

	if (p->on)
		points_changes(&p->points, face->ows, &p->pending, signals, n, ows_now());
}

static void pushing_event(struct face *face, const struct face_event *event)
{
	struct pushing *p = face->own;
	int64_t now_ns = ows_now();

	switch (event->news) {
	case FACE_FOUND:
	case FACE_RELOADED:
		take_file(face, now_ns);
		break;
	case FACE_FILE:
		take_file(face, now_ns);
		if (face->live)
			pushing_changes(face, NULL, 0);
		break;
	case FACE_LOST:
		points_lost(&p->points, &p->pending, now_ns);
		log_warning(face->log, "owsd is lost: no value is good");
		break;
	case FACE_OVERRUN:
		log_warning(face->log, "more changed than could be followed: some values are not "
		                       "sent");
		break;
	case FACE_ALARM:
	case FACE_COMMAND:
	case FACE_ENTRIES_LOST:
		break;
	case FACE_DESCRIPTOR:
		push_on(face, event->fd, event->ready);
		break;
	}
}

static int check(const struct face *face)
{
	return secret_check(face->ops->program, "TokenFile", face->config->influx.token_file,
	                    SECRET_TOKEN);
}

int main(int argc, char **argv)
{
	static const struct face_ops ops = {
		.program = "owsd-influx",
		.check = check,
		.open = pushing_open,
		.changes = pushing_changes,
		.event = pushing_event,
		.tick = pushing_tick,
		.close = pushing_close,
		.report = pushing_report,
	};

	return face_main(&ops, argc, argv);
}
