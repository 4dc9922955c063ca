/* SPDX-License-Identifier: MIT */
/* What the recorder does with the news of owsd, and with those of its disk. */
#include <assert.h>
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "hal/base/time.h"
#include "src/faces/kit/look.h"
#include "src/faces/kit/loop.h"
#include "src/history/file/place.h"
#include "src/history/recorder/recording.h"
#include "src/history/recorder/series.h"

/* Of changes of a signal that come closer together the newest is kept */
#define PACE_NS (20 * NS_PER_MS)
#define TICK_NS NS_PER_S
/* Of a bus that answers slowly; no longer than most commits wait anyway */
#define AFTER_NS (10 * NS_PER_S)
/* Each second the loop looks: a look that is later than that is late */
#define LATE_NS (2 * NS_PER_S)
/* In memory while the disk takes nothing: hours of a small plant */
#define MEMORY_BYTES (4u << 20)
/* So much stays free on the disk, for others */
#define SPARE_BYTES (64u << 20)

static void report_file(void *ctx, const char *text)
{
	struct log *log = ctx;

	log_err(log, "history %s", text);
}

/* Of all that changed before that time the history knows. */
static int64_t seen_until(const struct face *face, int64_t now_ns)
{
	/* of an owsd that is not there nothing is missed */
	return face->live ? face->looked_ns : now_ns;
}

/* Option -d, else the block's Directory, else the default. */
static int choose_directory(struct face *face, char path[HISTORY_PATH])
{
	const char *given = face->arguments->option ? face->arguments->option
	                                            : face->config->recorder.directory;

	if (!given)
		return history_place(face->arguments->instance, path);
	return snprintf(path, HISTORY_PATH, "%s", given) < HISTORY_PATH ? 0 : -ENAMETOOLONG;
}

/* What to do about a disk that takes nothing, besides what its error says. */
static const char *advice_on_disk(const struct recording *r, int err)
{
	if (err == -ENOENT && !r->files && access(r->directory, F_OK) < 0)
		return "; there is no such directory, and it cannot be made: Directory or -d "
		       "gives another";
	switch (err) {
	case -EBUSY:
		return "; another owsd-recorder writes there: end it, or give one of the two "
		       "another Directory";
	case -ENOENT:
		return "; its file was deleted, with what was in it, or its disk unmounted: "
		       "another is begun when there is a directory";
	case -EAGAIN:
		return "; another program has history.sqlite locked";
	case -EACCES:
		return "; it, or a file in it, is of another user: chown it";
	case -EPROTONOSUPPORT:
		return "; history.sqlite is of a newer owsd-recorder: install that, or move the "
		       "file away";
	case -EEXIST:
		return "; history.sqlite is there, and is no history of owsd: move it away";
	case -EISDIR:
		return "; history.sqlite is in the way: move it away";
	case -ELOOP:
		return "; history.sqlite is a link: move it away";
	default:
		return "";
	}
}

/* Also says at once whether the file can be used: what it returns then is no error. */
static int open_writer(struct face *face, int64_t now_ns, int *disk_err)
{
	struct recording *r = face->own;
	const struct config_recorder *options = &face->config->recorder;
	struct history_options to = {
		.directory = r->directory,
		.boot = r->boot,
		.flush_ns = options->flush_ns,
		.memory_bytes = MEMORY_BYTES,
		.keep = {.days = options->keep_days,
	                 .minutes = options->keep_minutes,
	                 .hours = options->keep_hours,
	                 .bytes = (uint64_t)options->size_mb * 1000000,
	                 .spare = SPARE_BYTES},
		.say = report_file,
		.ctx = face->log,
	};
	int64_t alarms_ns, commands_ns;
	int err;

	history_make_above(r->directory);
	r->options = *options;
	r->options.directory = NULL; /* it belongs to the configuration, which is replaced */
	r->options.record_text = NULL;
	r->dropped = 0;
	r->files = 0;
	err = history_writer_open(&to, now_ns, r->clock.offset_ns, r->clock.trusted, &r->writer);
	if (err)
		return err;
	log_info(face->log, "Keep %u, KeepMinutes %u, KeepHours %u, Size %llu MB, Flush %g s",
	         to.keep.days, to.keep.minutes, to.keep.hours,
	         (unsigned long long)(to.keep.bytes / 1000000), (double)to.flush_ns / NS_PER_S);
	*disk_err = history_writer_known(r->writer, &alarms_ns, &commands_ns);
	/* what an earlier run of this boot has */
	if (alarms_ns > face->alarms_after_ns)
		face->alarms_after_ns = alarms_ns;
	if (commands_ns > face->commands_after_ns)
		face->commands_after_ns = commands_ns;
	return 0;
}

int recording_open(struct face *face)
{
	static struct recording recording;
	struct recording *r = face->own = &recording;
	int64_t now_ns = ows_now();
	int err, disk_err = 0;

	*r = (struct recording){0};
	err = choose_directory(face, r->directory);
	if (err) {
		face_complain(face->ops->program, "the directory's path is too long");
		return err;
	}
	r->boot = history_boot_present();
	wall_clock_open(&r->clock);
	err = open_writer(face, now_ns, &disk_err);
	/* all else may be over some day, and until then it is in memory */
	if (!err && disk_err == -EBUSY) {
		history_writer_close(r->writer, now_ns); /* it has nothing yet */
		err = disk_err;
	}
	if (err) {
		face_complain(face->ops->program, "%s: %s%s", r->directory, strerror(-err),
		              advice_on_disk(r, err));
		return err;
	}
	face->pace_ns = PACE_NS;
	face->after_ns = AFTER_NS;
	face->tick_ns = now_ns;
	log_info(face->log, "history in %s", r->directory);
	return 0;
}

/* The table of signals is new. */
static void make_series(struct face *face, int64_t now_ns)
{
	struct recording *r = face->own;
	int err = series_make(&r->rows, face->ows, face->config, r->writer, now_ns);
	struct history_state state;

	if (err) {
		/* what was known would be repeated, and look constant */
		history_writer_gap(r->writer, now_ns, now_ns, OWS_HISTORY_NOT_ASKED);
		log_err(face->log, "%d signals cannot be recorded: %s", ows_count(face->ows),
		        strerror(-err));
	} else {
		history_writer_state(r->writer, &state);
		log_notice(face->log, "recording %d of %d signals into %s%s", r->rows.recorded,
		           r->rows.count, state.error ? "memory, until it can be written: " : "",
		           r->directory);
	}
	face->tick_ns = now_ns;
}

static void owsd_found(struct face *face, int64_t now_ns)
{
	struct recording *r = face->own;

	make_series(face, now_ns);
	if (!r->begun)
		history_writer_begin(r->writer, now_ns);
	else
		history_writer_gap(r->writer, r->lost_ns ? r->lost_ns : now_ns, now_ns,
		                   OWS_HISTORY_OWSD_LOST);
	r->begun = true;
	r->lost_ns = 0;
	series_forget(&r->rows, now_ns);
}

/*
 * Since its last heartbeat nothing of owsd is known; what was recorded is. The gap is recorded at
 * once: if the recorder ended now, nothing would look like a constant.
 */
static void owsd_lost(struct face *face, int64_t now_ns)
{
	struct recording *r = face->own;
	struct ows_daemon daemon;
	int64_t from_ns = face->looked_ns;

	if (ows_daemon(face->ows, now_ns, &daemon) != -EAGAIN && daemon.beat_age_ns >= 0 &&
	    now_ns - daemon.beat_age_ns < from_ns)
		from_ns = now_ns - daemon.beat_age_ns;
	if (from_ns < r->rows.last_ns)
		from_ns = r->rows.last_ns;
	if (from_ns > now_ns)
		from_ns = now_ns;
	r->lost_ns = from_ns;
	history_writer_gap(r->writer, from_ns, now_ns, OWS_HISTORY_OWSD_LOST);
	series_forget(&r->rows, now_ns);
	log_warning(face->log, "owsd is lost: a gap in the history, since %.1f s ago",
	            (double)(now_ns - from_ns) / 1e9);
}

static void changes_missed(struct face *face, int64_t now_ns)
{
	struct recording *r = face->own;

	history_writer_gap(r->writer, face->looked_ns, now_ns, OWS_HISTORY_OVERRUN);
	series_forget(&r->rows, now_ns);
	log_warning(face->log, "more changed than could be followed: a gap of %.1f s",
	            (double)(now_ns - face->looked_ns) / 1e9);
}

static bool same_options(const struct config_recorder *a, const struct config_recorder *b)
{
	return a->keep_days == b->keep_days && a->keep_minutes == b->keep_minutes &&
	       a->keep_hours == b->keep_hours && a->size_mb == b->size_mb &&
	       a->flush_ns == b->flush_ns;
}

/* What the file says of keeping may be new: then the writer begins anew, with a moment's gap. */
static void take_options(struct face *face, int64_t now_ns)
{
	struct recording *r = face->own;
	char directory[HISTORY_PATH];
	int err, disk_err = 0;

	if (choose_directory(face, directory))
		return;
	if (!strcmp(directory, r->directory) && same_options(&r->options, &face->config->recorder))
		return;
	err = history_writer_close(r->writer, seen_until(face, now_ns));
	if (err)
		log_err(face->log, "%s: %s: what was in memory is lost", r->directory,
		        strerror(-err));
	memcpy(r->directory, directory, sizeof(directory));
	r->writer = NULL;
	err = open_writer(face, now_ns, &disk_err);
	if (err)
		log_err(face->log, "nothing is recorded: %s", strerror(-err));
	r->begun = false;
}

/* SIGHUP, or owsd has reloaded its file: rules, options and perhaps the table are new. */
static void file_renewed(struct face *face, int64_t now_ns)
{
	struct recording *r = face->own;

	take_options(face, now_ns);
	if (!r->writer || !face->live)
		return;
	/* nothing was missed: new rows keep each value anew, with the time of its measurement */
	if (r->begun) {
		make_series(face, now_ns);
	} else {
		r->lost_ns = 0;
		owsd_found(face, now_ns);
	}
}

static void take_entry(struct recording *r, const struct face_event *event)
{
	struct history_event entry = event->news == FACE_ALARM ? entries_alarm(event->alarm)
	                                                       : entries_command(event->command);

	if (entry.signal < (uint32_t)r->rows.count)
		history_writer_event(r->writer, &entry);
}

static void note_clock(struct face *face, int64_t now_ns)
{
	struct recording *r = face->own;
	int64_t before_ns = r->clock.offset_ns;

	if (!wall_clock_look(&r->clock, now_ns))
		return;
	history_writer_clock(r->writer, now_ns, r->clock.offset_ns, r->clock.trusted);
	if (r->clock.offset_ns != before_ns)
		log_notice(face->log, "the clock was set, by %+.3f s",
		           (double)(r->clock.offset_ns - before_ns) / 1e9);
}

void recording_event(struct face *face, const struct face_event *event)
{
	struct recording *r = face->own;
	int64_t now_ns = ows_now();

	if (!r->writer && event->news != FACE_FILE && event->news != FACE_RELOADED &&
	    event->news != FACE_FOUND)
		return;
	switch (event->news) {
	case FACE_FOUND:
		take_options(face, now_ns);
		if (r->writer)
			owsd_found(face, now_ns);
		break;
	case FACE_RELOADED:
		file_renewed(face, now_ns);
		break;
	case FACE_LOST:
		owsd_lost(face, now_ns);
		break;
	case FACE_OVERRUN:
		changes_missed(face, now_ns);
		break;
	case FACE_FILE:
		file_renewed(face, now_ns);
		if (r->writer && face->live)
			recording_changes(face, NULL, 0);
		break;
	case FACE_ALARM:
	case FACE_COMMAND:
		take_entry(r, event);
		break;
	case FACE_ENTRIES_LOST:
		log_warning(face->log,
		            "%u alarms or commands came too fast, and are not in the history",
		            (unsigned)event->count);
		break;
	case FACE_DESCRIPTOR:
		break;
	}
}

/* For a starved machine, a stopped process or a slow disk: 0, or since when the loop was late. */
static int64_t unseen_since(int64_t looked_ns, int64_t now_ns)
{
	return now_ns - looked_ns > LATE_NS ? looked_ns : 0;
}

static void report_missed(struct face *face)
{
	struct recording *r = face->own;

	if (r->rows.missed)
		log_warning(face->log,
		            "the recorder could not look for a time: a gap of %d signals that may "
		            "have changed more than once",
		            r->rows.missed);
	r->rows.missed = 0;
}

void recording_changes(struct face *face, const int *signals, int n)
{
	struct recording *r = face->own;
	int64_t now_ns = ows_now();

	if (!r->writer)
		return;
	assert(series_are_of(&r->rows, face->ows, now_ns));
	series_changes(&r->rows, face->ows, r->writer, signals, n,
	               unseen_since(face->looked_ns, now_ns), now_ns);
}

/* Once when it begins, once when it is over. */
static void report_disk(struct face *face, const struct history_state *state)
{
	struct recording *r = face->own;

	if (state->error && !r->disk_err)
		log_err(face->log,
		        "%s cannot be written: %s%s; up to %u kB are kept in memory, and written "
		        "when that is over",
		        r->directory, strerror(-state->error), advice_on_disk(r, state->error),
		        MEMORY_BYTES / 1024);
	else if (state->error && state->error != r->disk_err)
		log_info(face->log, "%s cannot be written yet: %s", r->directory,
		         strerror(-state->error));
	if (!state->error && r->disk_err) {
		bool other = r->files && state->files != r->files;

		log_notice(face->log, "%s is written again%s; %llu rows that waited were lost",
		           r->directory,
		           other ? ", in another file: it has nothing of the one before" : "",
		           (unsigned long long)(state->dropped - r->dropped));
		r->dropped = state->dropped;
	}
	if (!state->error)
		r->files = state->files;
	r->disk_err = state->error;
}

static void recording_status(struct face *face, const struct history_state *state)
{
	struct recording *r = face->own;

	if (state->error)
		face_status(face, "%s cannot be written: %s; %u kB in memory, %llu rows lost",
		            r->directory, strerror(-state->error), state->waiting / 1024,
		            (unsigned long long)(state->dropped - r->dropped));
	else if (!face->live)
		face_status(face, "waiting for owsd %s", face->arguments->instance);
	else
		face_status(face, "%d signals into %s, %llu rows written", r->rows.recorded,
		            r->directory, (unsigned long long)state->rows);
}

void recording_report(struct face *face, FILE *out)
{
	const struct recording *r = face->own;

	if (r->disk_err)
		fprintf(out, "trouble %s cannot be written: %s%s\n", r->directory,
		        strerror(-r->disk_err), advice_on_disk(r, r->disk_err));
}

/* The wall-clock time of the next interval as a boot time, not later than the next tick. */
static int64_t next_tick(const struct recording *r, int64_t due_ns, int64_t now_ns)
{
	int64_t tick_ns = now_ns + TICK_NS;

	if (due_ns != INT64_MAX && due_ns - r->clock.offset_ns < tick_ns)
		tick_ns = due_ns - r->clock.offset_ns;
	return tick_ns > now_ns ? tick_ns : now_ns + NS_PER_MS;
}

void recording_tick(struct face *face, int64_t now_ns)
{
	struct recording *r = face->own;
	int64_t due_ns = INT64_MAX;
	struct history_state state;

	face->tick_ns = now_ns + TICK_NS;
	if (!r->writer)
		return;
	note_clock(face, now_ns);
	/* an image that is new has no rows yet */
	if (look_is_current(face) && r->begun) {
		assert(series_are_of(&r->rows, face->ows, now_ns));
		due_ns = series_tick(&r->rows, face->ows, r->writer,
		                     unseen_since(r->ticked_ns, now_ns), now_ns,
		                     now_ns + r->clock.offset_ns);
	}
	r->ticked_ns = now_ns;
	report_missed(face);
	face->tick_ns = next_tick(r, due_ns, now_ns);
	history_writer_tick(r->writer, seen_until(face, now_ns));
	history_writer_state(r->writer, &state);
	report_disk(face, &state);
	recording_status(face, &state);
}

void recording_close(struct face *face)
{
	struct recording *r = face->own;
	int err;

	err = history_writer_close(r->writer, seen_until(face, ows_now()));
	if (err)
		log_err(face->log, "%s: %s: what was in memory is lost", r->directory,
		        strerror(-err));
	series_free(&r->rows);
}
