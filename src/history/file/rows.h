/* SPDX-License-Identifier: MIT */
/*
 * Rows that wait in memory for a commit. When it is full the oldest half of them becomes a gap,
 * after which each signal has what it had at its end; signals that are too many for that are known
 * again when they are repeated.
 */
#pragma once

#include "src/history/file/store.h"

#define ROW_OF_ALL UINT32_MAX /* the key of a gap of all signals */

/* All zero: not open. */
struct history_rows {
	struct history_row *rows;
	uint32_t count, most, seq;
	size_t text_bytes, text_most; /* of texts and events */
	uint64_t dropped;             /* lost in gaps */
};

/* Room for so many bytes of rows, and as many of texts. 0 or -ENOMEM. */
int rows_open(struct history_rows *rows, uint32_t bytes);
void rows_close(struct history_rows *rows);
/* The row's memory belongs to the rows now. key_count: how many signals there are. */
void rows_add(struct history_rows *rows, struct history_row row, uint32_t key_count);
/* By their times; those of the same time stay in their order. */
void rows_sort(struct history_rows *rows);
/* The first so many are not needed any more. */
void rows_remove(struct history_rows *rows, uint32_t count);
