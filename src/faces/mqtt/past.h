/* SPDX-License-Identifier: MIT */
/*
 * What a broker has missed goes out again: after a birth the rows of the history between the moment
 * up to which the broker has all and that birth follow the live values, a few at a time. That a
 * broker has something is known by its answer to a mark, which goes after it on the same
 * connection.
 */
#pragma once

#include "src/faces/kit/face.h"
#include "src/faces/kit/missed.h"
#include "src/faces/mqtt/broker.h"
#include "src/faces/mqtt/stream.h"

struct past {
	struct face *face;
	struct stream *stream;
	struct broker *broker;
	struct missed missed;
	bool on;   /* the profile can show what was */
	bool lost; /* the broker does not get what changes now */
	bool due;  /* rows are due at missed.next_ns; else the next event comes first */
	bool marking, mark_batch; /* a mark is under way; behind a batch */
	struct replay_point mark; /* what it is of */
	int64_t marked_ns;
	uint64_t mark_published;
	struct past_value *values; /* under way, by chip */
	int value_count, put;
	int64_t offset_us;        /* of the clock, by which they have their times */
	bool read;                /* a batch is under way: it may have no values */
	struct replay_point last; /* its last row */
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
