/* SPDX-License-Identifier: MIT */
/*
 * Sums that are over go to the file. The minutes of a signal wait until their hour is over, for one
 * row that holds them all: a row for each costs a card more than the values.
 */
#pragma once

#include "src/history/file/minutes.h"
#include "src/history/file/statements.h"

/* The minutes of signals beyond that go to the file one by one, as memory for them is dear. */
#define SUMS_HELD 256

/* All zero: nothing waits. */
struct sums {
	sqlite3_stmt **statements;
	struct minute *held[SUMS_HELD]; /* of a signal, by its number; NULL: none yet */
	int64_t hour;                   /* the file has all before that one */
};

/* Forget all that waits; the file has all before that hour. */
void sums_begin(struct sums *sums, int64_t hour);
void sums_free(struct sums *sums);
/* A rolling_give; ctx is the sums. 0, -ENOMEM or the error of the disk. */
int sums_give(void *ctx, bool hour, int64_t bucket, uint32_t signal, const struct rollup *sum,
              const struct rollup_state *state);
