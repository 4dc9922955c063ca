/* SPDX-License-Identifier: MIT */
/*
 * Batches on their way: copied from memory, sent, taken, refused; and what the server has missed,
 * from the history. face->own is a pushing.
 *
 * Room src/faces/influx: the program owsd-influx: pushes signals to a server.
 */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "src/faces/influx/options.h"
#include "src/faces/influx/pending.h"
#include "src/faces/influx/points.h"
#include "src/faces/kit/backoff.h"
#include "src/faces/kit/missed.h"
#include "src/faces/kit/secret.h"
#include "src/faces/kit/wall_clock.h"

struct face;
struct post;
struct post_result;

enum push_trouble {
	PUSH_WELL,
	PUSH_AWAY,   /* the server is not there, or cannot take anything now */
	PUSH_DENIED, /* it does not let us in, or has no such address */
};

struct pushing {
	bool on; /* the file has the block */
	struct push_options options;
	struct wall_clock clock;
	bool believed; /* the wall clock, since it was trusted, or was not set for too long */
	struct points points;
	struct pending pending;
	struct missed missed;
	int64_t missed_ns;      /* in memory is all since then; 0: missed knows of that */
	struct replay_point at; /* of the last row of the history in memory */
	uint64_t rows_end;      /* the number behind its line; 0: there is none */
	int rows;               /* how many */
	struct post *post;
	char token[SECRET_SIZE], batch[BATCH_BYTES];
	uint64_t token_print; /* of why there is no token, as it was logged last */
	size_t batch_len;     /* of what is under way */
	unsigned batch_lines;
	uint64_t batch_end; /* the number behind its last line */
	bool batch_all;     /* it is all that there was in memory */
	int64_t looked_ns;  /* when it was copied: of all that changed before memory had a line */
	size_t most;        /* bytes that the server takes at once */
	enum push_trouble trouble;
	bool refused;            /* the server refused lines, and has taken none since */
	int64_t cut_ns, next_ns; /* when to make a batch; when to send one */
	struct backoff backoff;
	uint64_t sent, refused_lines; /* lines that arrived; that the server did not want */
	uint64_t lost_lines;          /* dropped, as it was logged last */
};

/* Read the token's file again, log an error once. Blocking, as a disk does. */
void sending_read_token(struct face *face);
/* Lines may have been dropped: the history has to have them. */
void sending_look_at_dropped(struct face *face);
/* Make a batch and send it, if it is time to; ending: it is. */
void sending_advance(struct face *face, bool ending, int64_t now_ns);
/* The server has answered, or will not. */
void sending_finished(struct face *face, const struct post_result *result, int64_t now_ns);
