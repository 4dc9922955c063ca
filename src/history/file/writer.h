/* SPDX-License-Identifier: MIT */
/*
 * The writer of history: what signals have, and gaps, into memory, and from there to the file. One
 * thread. Calls that take something never fail and touch no disk: what the disk does not take stays
 * in memory, and when that is full the oldest half of it becomes a gap. Only history_writer_tick(),
 * _flush(), _close() and _known() touch the disk (and wait for it).
 *
 * The order of calls: open, signals, then begin and a value of each signal; then values as they
 * come and tick() at least each second. A value that holds is repeated each hour, and after the
 * file was replaced.
 */
#pragma once

#include "src/history/file/keep.h"
#include "src/history/file/record.h"

struct history_writer;

struct history_options {
	const char *directory; /* made if it is missing; its parent has to be there */
	int64_t boot;          /* history_boot_present() */
	int64_t flush_ns;      /* from one commit to the next at most; 0: ten minutes */
	uint32_t memory_bytes; /* kept while the disk fails; 0: 4 MiB */
	struct history_keep keep;
	void (*say)(void *ctx, const char *text); /* of a damaged file; NULL: it is not reported */
	void *ctx;
};

/*
 * Open. now_ns is boot time, offset_ns wall clock minus boot time. The file is opened by the first
 * of the calls that touch the disk. -ENOMEM.
 */
int history_writer_open(const struct history_options *options, int64_t now_ns, int64_t offset_ns,
                        bool trusted, struct history_writer **writer);
/* Write all, and the end. NULL: nothing. Returns the error of the disk, if something is lost. */
int history_writer_close(struct history_writer *writer, int64_t now_ns);

/*
 * The table: signal i of the calls below is signals[i]. Again after a reload: values of signals
 * with the same identity stay known, of those that are gone nothing is known from now on. -ENOMEM,
 * -E2BIG: too many; the table is as before.
 */
int history_writer_signals(struct history_writer *writer, const struct history_signal *signals,
                           uint32_t count, int64_t now_ns);

/* The recorder begins to look. All values are unknown. */
void history_writer_begin(struct history_writer *writer, int64_t now_ns);
/*
 * A value, measured at measured_ns. text and len: of a string. A measurement older than the last
 * one of the signal is taken as of the time of that.
 */
void history_writer_value(struct history_writer *writer, uint32_t signal, int64_t measured_ns,
                          uint8_t quality, int64_t value, const char *text, size_t len);
/* Nothing is known of the signal from that time on. */
void history_writer_forget(struct history_writer *writer, uint32_t signal, int64_t from_ns,
                           enum ows_history_reason reason);
/* Between two times no recorder looked. All values are unknown after it: record each anew. */
void history_writer_gap(struct history_writer *writer, int64_t from_ns, int64_t until_ns,
                        enum ows_history_reason reason);
/* The wall clock was set, or is trusted now. */
void history_writer_clock(struct history_writer *writer, int64_t now_ns, int64_t offset_ns,
                          bool trusted);
void history_writer_event(struct history_writer *writer, const struct history_event *event);

/*
 * The recorder has looked until now_ns. Commits what is due: alarms, commands, gaps and the begin
 * of a run at once, but ten seconds after the last commit at the soonest; values as flush_ns says,
 * or after a minute if there are 64 kB of them. Tries a failed disk again (after 1 s,
 * then twice as long each time, 60 s at most). Returns 0, or the error of the disk that it met.
 */
int history_writer_tick(struct history_writer *writer, int64_t now_ns);
/* Commit all that is there, now. */
int history_writer_flush(struct history_writer *writer, int64_t now_ns);
/*
 * The newest alarm and the newest command that the file has of this boot, as boot times; 0: none.
 * Opens the file: returns the error of that.
 */
int history_writer_known(struct history_writer *writer, int64_t *alarms_ns, int64_t *commands_ns);

struct history_state {
	int error;        /* of the disk: 0 or a negative errno */
	uint32_t waiting; /* bytes in memory */
	uint64_t dropped; /* rows that were lost since the start */
	uint64_t rows;    /* written since the start */
	uint64_t commits;
	uint32_t files; /* begun so far; one more: it has nothing of those before */
};
void history_writer_state(const struct history_writer *writer, struct history_state *state);
