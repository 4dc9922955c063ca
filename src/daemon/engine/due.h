/* SPDX-License-Identifier: MIT */
/*
 * What is due: a set of table rows with a cursor that goes round in table order, and a wheel that
 * puts rows into the set when their period comes. Cost does not grow with the table: a row costs
 * one step when it is scheduled, one when it becomes due and one when it is taken.
 */
#pragma once

#include <stdbool.h>
#include <stdint.h>

struct due_set {
	uint32_t size;     /* rows 0 .. size - 1 */
	uint32_t count;    /* rows in the set */
	uint32_t cursor;   /* the next row to be looked at */
	uint32_t *word;    /* one bit a row */
	uint32_t *summary; /* one bit a word */
};

int due_set_init(struct due_set *set, uint32_t size); /* 0 or -ENOMEM */
void due_set_free(struct due_set *set);
void due_set_add(struct due_set *set, uint32_t row);
void due_set_remove(struct due_set *set, uint32_t row);
bool due_set_has(const struct due_set *set, uint32_t row);
/* The next row at or after the cursor, going round; -1 if the set is empty. Takes nothing away. */
int64_t due_set_next(const struct due_set *set);
/* Take row away and put the cursor behind it. */
void due_set_take(struct due_set *set, uint32_t row);

/* Rows waiting for a period. A row waits for one period at a time. */
#define DUE_BUCKETS 1024
#define DUE_NONE UINT32_MAX
struct due_wheel {
	uint64_t period; /* the last one that it was advanced to */
	uint32_t size;
	uint32_t bucket[DUE_BUCKETS];
	uint32_t used[DUE_BUCKETS / 32]; /* one bit a bucket that is not empty */
	struct due_wait {
		uint64_t period;
		uint32_t next, prev; /* rows in the list of the bucket; DUE_NONE: there is none */
		bool waits;          /* the row is in a bucket; if not, the others mean nothing */
	} * wait;
};

int due_wheel_init(struct due_wheel *wheel, uint32_t size, uint64_t period);
void due_wheel_free(struct due_wheel *wheel);
/* Let row wait for period (not in the past: at least the next one); replaces an earlier wait. */
void due_wheel_at(struct due_wheel *wheel, uint32_t row, uint64_t period);
void due_wheel_cancel(struct due_wheel *wheel, uint32_t row);
/* Advance to period; calls ready() for each row that waited for a period up to that. */
typedef void due_ready(void *ctx, uint32_t row);
void due_wheel_advance(struct due_wheel *wheel, uint64_t period, due_ready *ready, void *ctx);
/*
 * The first period after `after` for which a row may wait, at most `most`, which is less than
 * DUE_BUCKETS later. It may be too soon: a row of a later round is in the same bucket.
 */
uint64_t due_wheel_next(const struct due_wheel *wheel, uint64_t after, uint64_t most);
