/* SPDX-License-Identifier: MIT */
/*
 * What a broker has missed goes out again, from the file of owsd-recorder: up to which moment the
 * broker has all is kept in a file of our own; after a birth the rows between that and the birth
 * follow the live values, a few at a time. That a broker has something is known by its answer to a
 * mark, which goes after it on the same connection.
 */
#pragma once

#include "src/faces/kit/face.h"
#include "src/faces/mqtt/broker.h"
#include "src/faces/mqtt/stream.h"
#include "src/history/file/place.h"
#include "src/history/library/replay.h"

#define PAST_WINDOWS 16

struct past_window {
	struct replay_point from, until;
};
struct past {
	struct face *face;
	struct stream *stream;
	struct broker *broker;
	bool on;     /* the profile can show what was */
	bool there;  /* there is a history */
	bool lost;   /* the broker does not get what changes now */
	bool logged; /* why nothing is sent again, or is not kept */
	bool worth;  /* what is missed is worth a line of the log */
	bool said;   /* that it goes out again */
	bool waits;  /* that the recorder has not written it, was said */
	bool due;    /* there is something to do at next_ns; else the next event comes first */
	bool dated;  /* the clock of this boot is known to be right */
	char path[HISTORY_PATH + 16];
	uint64_t key;                             /* of what there is one order of values for */
	int64_t boot;                             /* that this machine is in */
	struct replay_point reached;              /* up to there the broker has all */
	struct replay_point born;                 /* the last birth */
	struct past_window windows[PAST_WINDOWS]; /* but this, the oldest first */
	int count;
	int64_t kept_ns, next_ns, wait_ns, moved_ns;
	bool marking, mark_batch; /* a mark is under way; behind a batch */
	struct replay_point mark; /* what it is of */
	int64_t marked_ns;
	uint64_t mark_published;
	struct ows_history *history;
	const struct row **by_identity; /* rows of the stream */
	int *rows;                 /* of signals of the history: the row; -1: none, -2: not known */
	struct past_value *values; /* under way, by chip */
	int value_count, put;
	bool read;                /* a batch is under way: it may have no values */
	struct replay_point next; /* behind it */
	uint64_t sent, filled, undated;
};

/* key: of another one what was kept does not count. The profile of the stream is known. */
void past_begin(struct past *p, uint64_t key);
/* Also before the rows of the stream are made anew. */
void past_drop(struct past *p);
void past_end(struct past *p);
/* The broker is away, or its session has ended. */
void past_lost(struct past *p);
/* All that is new has gone to the broker: go on. */
void past_pump(struct past *p, int64_t now_ns);
/* When to go on at the latest. */
int64_t past_next(const struct past *p);
