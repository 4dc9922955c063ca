/* SPDX-License-Identifier: MIT */
/*
 * Batches on their way: cut from memory, put into the spool, sent, refused. face->own is a pushing.
 */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "src/faces/influx/options.h"
#include "src/faces/influx/part.h"
#include "src/faces/influx/pending.h"
#include "src/faces/influx/points.h"
#include "src/faces/influx/spool.h"
#include "src/faces/kit/backoff.h"
#include "src/faces/kit/secret.h"
#include "src/faces/kit/wall_clock.h"
#include "src/ground/text/log.h"

struct face;
struct post;
struct post_result;

enum push_trouble {
	PUSH_WELL,
	PUSH_AWAY,   /* the server is not there, or cannot take anything now */
	PUSH_DENIED, /* it does not let us in, or has no such address */
};

struct pushing {
	bool on; /* the file has the block, and the spool is open */
	struct push_options options;
	struct wall_clock clock;
	bool believed; /* the wall clock, since it was trusted, or was not set for too long */
	struct points points;
	struct pending pending;
	struct spool spool;
	struct post *post;
	char token[SECRET_SIZE], batch[BATCH_BYTES];
	uint64_t token_print;    /* of why there is no token, as it was logged last */
	char later[BATCH_BYTES]; /* goes into the spool while the batch is under way */
	size_t batch_len;        /* of what is sent or has to be sent next; 0: nothing */
	struct part part;        /* of the batch: what is sent now */
	uint64_t spooled;        /* the number of the file of the spool that has it, too; 0: none */
	enum push_trouble trouble;
	int disk_err;            /* as it was logged last */
	struct log_rate unread;  /* files of the spool that could not be read */
	bool refused;            /* the server refused lines, and has taken none since */
	int64_t cut_ns, next_ns; /* when to make a batch; when to send one */
	int64_t begun_ns;        /* when the last one was begun */
	struct backoff backoff;
	uint64_t sent;                   /* lines that arrived */
	uint64_t refused_batches;        /* also those of which no file is kept any more */
	uint64_t lost_bytes, lost_lines; /* dropped, as it was logged last */
};

/* Read the token's file again, log an error once. Blocking, as a disk does; so do the others. */
void sending_read_token(struct face *face);
/* err is that of the spool's directory, 0: it works. Logs it once. */
void sending_report_disk(struct face *face, int err);
/* The oldest lines of the memory become the batch. */
void sending_cut(struct pushing *p);
/* The batch goes into the spool. False: it stays in memory. */
bool sending_put_away(struct face *face);
/* The batch has arrived, or is lost. */
void sending_drop(struct pushing *p);
/* Make a batch and send one, if it is time to. */
void sending_advance(struct face *face, int64_t now_ns);
/* The server has answered, or will not. */
void sending_finished(struct face *face, const struct post_result *result, int64_t now_ns);
