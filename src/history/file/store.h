/* SPDX-License-Identifier: MIT */
/*
 * The writer's rows on their way into the file: a commit at a time, with the roll-ups that are
 * over, and what is old deleted. After an error the file is opened again. One thread, blocking.
 */
#pragma once

#include "src/history/file/file.h"
#include "src/history/file/keep.h"
#include "src/history/file/record.h"
#include "src/history/file/rolling.h"
#include "src/history/file/statements.h"
#include "src/history/file/sums.h"

/* A signal, by its identity; its number is that of the file, 0: not looked up. */
struct history_key {
	char identity[HISTORY_IDENTITY], name[HISTORY_NAME], unit[HISTORY_UNIT];
	uint8_t type, output;
	int8_t decimals;
	uint32_t number;
	int64_t last_id; /* of its newest row */
};

/* Of a signal that is no more: what is left of it is not to take a name back that another has. */
void history_key_leave(struct history_key *key, const struct history_signal *signals,
                       uint32_t count);

enum history_row_kind { ROW_VALUE, ROW_GAP, ROW_EVENT, ROW_CLOCK };
struct history_row {
	int64_t us;    /* boot time */
	int64_t value; /* of a value; until when, of a gap of all; how far, of a clock */
	char *text;    /* of a string, owned */
	struct history_event *event; /* owned */
	uint32_t key;                /* index; of a gap UINT32_MAX: of all */
	uint32_t seq;                /* rows of the same time stay in their order */
	uint8_t kind, type, quality;
	uint8_t reason; /* of a gap */
};

struct history_store {
	struct history_file file;
	struct history_keep keep;
	int64_t boot;
	/* The rest is the store's own. */
	sqlite3_stmt *statements[S_COUNT];
	bool stale;          /* what is below has to be read from the file */
	int64_t start, base; /* of this run in the file; start 0: not begun */
	int64_t last_id, seen_us;
	int64_t gap_us, gap_start; /* the last gap of all */
	uint8_t gap_reason;
	struct rolling rolling;
	struct sums sums;
	uint32_t begun; /* how often this run began in a file */
	uint64_t commits, rows;
};

/* All that came, in the order of time, and how the wall clock stands. */
struct store_batch {
	struct history_key *keys;
	uint32_t key_count;
	const struct history_row *rows;
	uint32_t count;
	int64_t begin_us;  /* when this run began */
	int64_t seen_us;   /* all before that is in rows */
	int64_t offset_us; /* wall clock minus boot time */
	bool trusted;
};

void store_begin(struct history_store *store);
void store_close(struct history_store *store);
/* Open the file if it is not. 0 or a negative errno: see file_open(). */
int store_ready(struct history_store *store);
/* Is there something to write, though no row waits? */
bool store_is_due(const struct history_store *store, int64_t seen_us);
/* All of it is in the file, or, with an error, nothing. */
int store_commit(struct history_store *store, struct store_batch *batch);
/* The newest boot times of alarms and commands that the file has of this boot; 0: none. */
int store_known(struct history_store *store, int64_t *alarms_ns, int64_t *commands_ns);
