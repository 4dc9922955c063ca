/* SPDX-License-Identifier: MIT */
/*
 * What a peer (a broker, a database) has missed, out of the file of owsd-recorder: up to which
 * moment the peer has all is kept in a file of the face; the rows between that and the moment from
 * which the peer gets what changes are given a batch at a time, a stretch of time after the other.
 */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "src/history/file/place.h"
#include "src/history/library/replay.h"

/* How often to keep what is known while all is well */
#define MISSED_KEEP_NS (60 * INT64_C(1000000000))
#define MISSED_NONE (-2) /* as signal of a row: the face has none of that identity and type */

#define MISSED_STRETCHES 16

struct face;
struct missed_stretch {
	struct replay_point from, until;
};
struct missed {
	struct face *face;
	const char *peer; /* "the broker" */
	const char *what; /* of the directory of its own: "mqtt" */
	/* Of a row of the face; false: it gets nothing. A batch has its number as its signal. */
	bool (*info)(void *ctx, int row, struct ows_info *info);
	void *ctx;
	bool dated; /* the clock of this boot is known to be right */

	/* of missed.c alone, but to look at */
	bool there;                                        /* there is a history */
	int64_t next_ns;                                   /* when to ask for rows */
	struct replay_point reached;                       /* up to there the peer has all */
	struct missed_stretch stretches[MISSED_STRETCHES]; /* but these, the oldest first */
	int count;
	struct replay_point resumed; /* when the peer got what changes again */
	bool logged, worth, said, waits;
	bool unread; /* there is a file, and nobody knows what is in it */
	char path[HISTORY_PATH + 16];
	uint64_t key;
	int64_t boot, kept_ns, wait_ns, moved_ns;
	struct ows_history *history;
	int *rows;               /* of signals of the history: the row; -1: not looked up */
	uint64_t given, undated; /* since count was 0 */
	uint64_t sent;           /* rows, of all */
};

/*
 * key: of another peer what was kept does not count. Nothing was kept: the peer has all. The peer
 * does not get what changes until missed_resume().
 */
void missed_begin(struct missed *m, uint64_t key, int64_t now_ns);
/*
 * A small number of the face beside what is known, between missed_begin() and the end; -1: none was
 * kept. It is kept without a history, too.
 */
int missed_number(const struct missed *m);
void missed_keep_number(struct missed *m, int number);
/* The rows of the face are others, or the configuration is; the end. */
void missed_drop(struct missed *m);
/* Write down what is known, unless that was done less than least_ns ago. */
void missed_keep(struct missed *m, int64_t least_ns, int64_t now_ns);
/* A moment of this boot as a point. */
struct replay_point missed_point(const struct missed *m, int64_t ns);
/* The peer has all that changed before that. */
void missed_has(struct missed *m, const struct replay_point *point);
/* From there on the peer gets what changes. */
void missed_resume(struct missed *m, const struct replay_point *point, int64_t now_ns);
/* Is there a history? */
bool missed_open(struct missed *m);
/* The same; looks seldom for one that is not there. */
bool missed_look(struct missed *m, int64_t now_ns);
/*
 * The next rows, up to most, of count rows of the face; a gap of all (signal -1) is the last or
 * the only one. Returns how many; 0: nothing now, next_ns says when, or a stretch is over. Texts
 * are the caller's to free.
 */
int missed_read(struct missed *m, int count, struct replay_row *rows, int most, int64_t now_ns);
/* The peer has the rows up to that one; sent: so many of them went to it. */
void missed_given(struct missed *m, const struct replay_point *last, int sent, int64_t now_ns);
