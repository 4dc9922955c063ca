/* SPDX-License-Identifier: MIT */
/* What a face learns of owsd: presence, changes, entries of the journals. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "hal/base/time.h"
#include "src/config/read/load.h"
#include "src/faces/kit/look.h"

/* --- The configuration ----------------------------------------------------------------------- */

/* Warnings are owsd's to report, of the same file. ctx: the face; it has no log at the start. */
static void report_line(void *ctx, bool is_error, const char *message)
{
	struct face *face = ctx;

	if (!is_error)
		return;
	if (!face->log) {
		fprintf(stderr, "%s\n", message);
		return;
	}
	log_err(face->log, "%s", message);
	if (!*face->refused)
		snprintf(face->refused, sizeof(face->refused), "%s", message);
}

int load_first(struct face *face)
{
	struct config_report report = {.line = report_line, .ctx = face};
	int err = config_load(face->arguments->file, &report, &face->config);

	if (err == -ENOENT && face->arguments->file == face->arguments->default_file)
		face_complain(face->ops->program, "-c FILE names another");
	face->loaded_ns = ows_now();
	return err;
}

void load_again(struct face *face)
{
	struct config_report report = {.line = report_line, .ctx = face};
	struct config *config;

	face->loaded_ns = ows_now();
	face->refused[0] = '\0';
	face->report_ns = 0;
	if (config_load(face->arguments->file, &report, &config)) {
		log_err(face->log, "%s is refused: what it said before counts on",
		        face->arguments->file);
		return;
	}
	config_free(face->config);
	face->config = config;
}

#define BATCH 256
#define ROUNDS 64 /* of batches in one look: after them the loop serves its other descriptors */
/* No event wakes a face when owsd dies or starts: it looks so often */
#define LOOK_NS NS_PER_S
#define OPEN_NS (200 * NS_PER_MS)
/* Without a descriptor of owsd; a face that cannot connect still sees all */
#define CONNECT_NS (10 * NS_PER_S)
#define BLIND_NS (100 * NS_PER_MS)
/* A reload is over sooner than that: then owsd was never away */
#define RELOAD_NS (20 * NS_PER_MS)
#define STALE_NS NS_PER_S
#define JOURNAL 256 /* entries that owsd keeps */

static void tell(struct face *face, enum face_news news)
{
	face->ops->event(face, &(struct face_event){.news = news});
}

static void tell_lost_entries(struct face *face, uint32_t lost)
{
	if (lost)
		face->ops->event(face,
		                 &(struct face_event){.news = FACE_ENTRIES_LOST, .count = lost});
}

/* Is the value after it still to come? Not so long that entries behind it are lost. */
static bool comes_later(const struct face *face, const struct ows_alarm *alarm, uint32_t behind)
{
	return alarm->kind == OWS_ALARM_DEVICE && alarm->event == OWS_ALARM_RAISED &&
	       !alarm->has_after && alarm->type != OWS_STRING && behind < JOURNAL / 2 &&
	       ows_now() - alarm->occurred_ns < face->after_ns;
}

/*
 * Entries that are not kept any more are counted; one that owsd is writing waits. all: also those
 * whose value may still come.
 */
static void take_alarms(struct face *face, bool all)
{
	uint32_t count = ows_alarm_count(face->ows), lost = 0;
	struct ows_alarm alarm;

	for (; face->next_alarm != count; face->next_alarm++) {
		int err = ows_alarm(face->ows, face->next_alarm, &alarm);

		if (err == -EAGAIN)
			break;
		if (err) {
			lost++;
			continue;
		}
		if (alarm.occurred_ns <= face->alarms_after_ns)
			continue;
		if (!all && comes_later(face, &alarm, count - face->next_alarm))
			break;
		face->ops->event(face, &(struct face_event){.news = FACE_ALARM, .alarm = &alarm});
	}
	tell_lost_entries(face, lost);
}

static void take_commands(struct face *face)
{
	uint32_t count = ows_command_count(face->ows), lost = 0;
	struct ows_commanded command;

	for (; face->next_command != count; face->next_command++) {
		int err = ows_command_entry(face->ows, face->next_command, &command);

		if (err == -EAGAIN)
			break;
		if (err) {
			lost++;
			continue;
		}
		if (command.taken_ns > face->commands_after_ns)
			face->ops->event(face, &(struct face_event){.news = FACE_COMMAND,
			                                            .command = &command});
	}
	tell_lost_entries(face, lost);
}

static void lose_owsd(struct face *face)
{
	if (!face->live)
		return;
	if (!face->fresh)
		take_alarms(face, true);
	face->live = false;
	tell(face, FACE_LOST);
}

/* The first entry of a journal that may still be kept. */
static uint32_t first_kept(uint32_t count)
{
	return count > JOURNAL ? count - JOURNAL : 0;
}

/* The image is another one, or the heart of owsd beats again. */
static void look_find(struct face *face, const struct ows_daemon *daemon)
{
	bool same_owsd = daemon->start_ns == face->start_ns;
	bool reloaded = face->live && same_owsd;

	if (!reloaded)
		lose_owsd(face);
	if (face->fresh)
		load_again(face);
	face->fresh = false;
	if (!same_owsd) {
		face->next_alarm = first_kept(ows_alarm_count(face->ows));
		face->next_command = first_kept(ows_command_count(face->ows));
	}
	face->start_ns = daemon->start_ns;
	face->live = true;
	if (!reloaded)
		log_notice(face->log, "owsd %s is there: %d signals", face->arguments->instance,
		           ows_count(face->ows));
	tell(face, reloaded ? FACE_RELOADED : FACE_FOUND);
	face->ops->changes(face, NULL, 0);
}

/*
 * "Look at all": why? It is said once that owsd is dead, by a time that is later than now_ns.
 * -EAGAIN: owsd died in the middle of a beat.
 */
static void find_out_why(struct face *face, int64_t now_ns)
{
	struct ows_daemon daemon;

	if (ows_daemon(face->ows, ows_now(), &daemon) || !daemon.alive) {
		lose_owsd(face);
		return;
	}
	if (!face->live || face->fresh) {
		look_find(face, &daemon);
	} else {
		tell(face, FACE_OVERRUN);
		face->ops->changes(face, NULL, 0);
	}
	face->looked_ns = now_ns;
}

static void report_open(struct face *face, int err)
{
	if (err == face->open_err)
		return;
	face->open_err = err;
	log_at(face->log, err == -ENOENT ? LOG_LEVEL_NOTICE : LOG_LEVEL_ERR,
	       "owsd %s cannot be opened: %s%s", face->arguments->instance, strerror(-err),
	       err == -ENOENT   ? "; waiting for it"
	       : err == -EACCES ? "; the group owsd may read"
	       : err == -EPROTO ? "; it is of another version"
	                        : "");
}

static bool open_again(struct face *face, int64_t now_ns)
{
	int err;

	if (now_ns < face->open_ns)
		return false;
	face->open_ns = now_ns + OPEN_NS;
	err = face->ows ? ows_reopen(face->ows)
	                : ows_open_as(face->arguments->instance, OWS_READ, face->ops->program,
	                              &face->ows);
	if (err) {
		/* a killed owsd leaves its image, and an ended one none */
		if (!face->ows || err != -ENOENT)
			report_open(face, err);
		return false;
	}
	face->open_err = 0;
	face->fresh = true;
	face->stale = false;
	return true;
}

/* -ESTALE: owsd has ended, was reloaded or is another. Not reached at once, it is lost. */
static bool open_present(struct face *face, int64_t now_ns)
{
	if (!face->stale) {
		/* an image that was opened just now was not looked at: its count is another */
		if (face->live && !face->fresh)
			take_alarms(face, true);
		face->stale = true;
		face->stale_ns = now_ns;
		face->open_ns = 0;
	}
	if (open_again(face, now_ns))
		return true;
	if (now_ns - face->stale_ns > STALE_NS)
		lose_owsd(face);
	return false;
}

/*
 * The descriptor that wakes the loop, silent until owsd publishes something after this call. A face
 * that owsd refuses, because too many programs are connected, looks at the image now and then.
 */
static void arm_descriptor(struct face *face, int64_t now_ns)
{
	if (face->stale || now_ns < face->fd_ns)
		return;
	face->fd = ows_fd(face->ows);
	if (face->fd < 0)
		face->fd_ns = now_ns + CONNECT_NS;
}

bool look_is_current(const struct face *face)
{
	return face->live && !face->fresh && !face->stale;
}

void look(struct face *face, int64_t now_ns)
{
	int signals[BATCH], n = 0;
	bool some = false;

	if (now_ns < face->look_ns || (!face->ows && !open_again(face, now_ns)))
		return;
	arm_descriptor(face, now_ns);
	/*
	 * Until owsd is found each look asks anew: the heart may have stopped or beaten between the
	 * answer of ows_changes(), which comes once, and that of ows_daemon()
	 */
	if (face->fresh || !face->live)
		face->cursor = (struct ows_cursor){0};
	for (int round = 0; round < ROUNDS; round++) {
		n = ows_changes(face->ows, &face->cursor, signals, BATCH, 0);
		if (n == -EOVERFLOW)
			find_out_why(face, now_ns);
		else if (n > 0 && face->live)
			face->ops->changes(face, signals, n);
		else if (n != -ESTALE || !open_present(face, now_ns))
			break;
		some = true;
	}
	if (n == -ENOMEM || n == -EOPNOTSUPP) {
		report_open(face, n);
		lose_owsd(face); /* changes cannot be had */
	}
	if (look_is_current(face)) {
		/* else more is to come, and what it is about may be older than this look */
		if (n == 0)
			face->looked_ns = now_ns;
		take_alarms(face, false);
		take_commands(face);
	}
	/* a look that found nothing has armed the descriptor, which wakes the loop at once */
	face->look_ns = some ? now_ns + face->pace_ns : now_ns;
}

int64_t look_next(const struct face *face, int64_t now_ns)
{
	if (now_ns < face->look_ns)
		return face->look_ns;
	if (face->stale || face->fresh)
		return now_ns + (face->live ? RELOAD_NS : OPEN_NS);
	return now_ns + (!face->ows || !face->live ? OPEN_NS : face->fd < 0 ? BLIND_NS : LOOK_NS);
}

int look_descriptor(const struct face *face, int64_t now_ns)
{
	return face->ows && !face->stale && now_ns >= face->look_ns ? face->fd : -1;
}
