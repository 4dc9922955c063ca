/* SPDX-License-Identifier: MIT */
/*
 * An answer that is made piece by piece, as fast as the client takes it: so a slow client costs one
 * piece of memory, and gets the newest state when it is ready again.
 */
#pragma once

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "src/faces/web/pace.h"

#define STREAMS 1000

struct request;
struct web;

enum stream_more {
	STREAM_MORE,  /* something was written */
	STREAM_SLEEP, /* nothing is there: stream_wake() goes on */
	STREAM_END,
	STREAM_BROKEN, /* end without an end that the client could believe */
};

struct stream {
	struct web *web;
	struct stream *next, *before; /* of web->streams */
	struct MHD_Connection *connection;
	/* The next piece. It may write and return STREAM_END. */
	enum stream_more (*fill)(struct stream *stream, FILE *out);
	char *text;
	size_t len, at;
	bool asleep, ended;

	/* of the answer: how far it has come */
	int row;
	struct position position;
	uint64_t alarms_seen;
	uint32_t refused_seen; /* number of the refused reload that the client knows */
	bool begun, told_lost;
	int64_t written_ns;
};

/* Answer with a stream of that type. *first is what it begins with, but for the first members. */
int stream_answer(struct request *request, const char *type, const struct stream *first);
/* All that sleep. */
void stream_wake_all(struct web *web);
