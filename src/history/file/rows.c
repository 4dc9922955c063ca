/* SPDX-License-Identifier: MIT */
/* Rows in memory, and what is left of them when it is full. */
#include "src/history/file/rows.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

int rows_open(struct history_rows *r, uint32_t bytes)
{
	r->most = bytes / (uint32_t)sizeof(*r->rows) + 2;
	r->text_most = bytes;
	r->rows = calloc(r->most, sizeof(*r->rows));
	return r->rows ? 0 : -ENOMEM;
}

void rows_close(struct history_rows *r)
{
	rows_remove(r, r->count);
	free(r->rows);
	r->rows = NULL;
}

static void free_row(struct history_rows *r, struct history_row *row)
{
	if (row->text)
		r->text_bytes -= strlen(row->text) + 1;
	if (row->event)
		r->text_bytes -= sizeof(*row->event);
	free(row->text);
	free(row->event);
	row->text = NULL;
	row->event = NULL;
}

static int by_time(const void *a, const void *b)
{
	const struct history_row *left = a, *right = b;

	if (left->us != right->us)
		return left->us < right->us ? -1 : 1;
	return left->seq < right->seq ? -1 : left->seq > right->seq;
}

void rows_sort(struct history_rows *r)
{
	qsort(r->rows, r->count, sizeof(*r->rows), by_time);
	for (uint32_t i = 0; i < r->count; i++)
		r->rows[i].seq = i;
	r->seq = r->count;
}

void rows_remove(struct history_rows *r, uint32_t count)
{
	for (uint32_t i = 0; i < count; i++)
		free_row(r, &r->rows[i]);
	r->count -= count;
	memmove(r->rows, r->rows + count, r->count * sizeof(*r->rows));
}

/* Of each key the row that has its value after the first `count`: its number plus 1; 0: none. */
static void find_last(const struct history_rows *r, uint32_t count, uint32_t *last,
                      uint32_t key_count)
{
	for (uint32_t i = 0; i < count; i++) {
		const struct history_row *row = &r->rows[i];

		if (row->kind == ROW_VALUE)
			last[row->key] = i + 1;
		else if (row->kind == ROW_GAP && row->key == ROW_OF_ALL)
			memset(last, 0, key_count * sizeof(*last));
		else if (row->kind == ROW_GAP)
			last[row->key] = 0;
	}
}

/*
 * Memory is full: the oldest half becomes a gap, after which each signal has what it had at its
 * end. Signals that are too many for that are known again when they are repeated.
 */
static void drop_half(struct history_rows *r, uint32_t key_count)
{
	uint32_t half, left = 0, *last = calloc(key_count + 1, sizeof(*last));
	struct history_row gap = {.kind = ROW_GAP, .key = ROW_OF_ALL, .reason = OWS_HISTORY_DISK};

	rows_sort(r);
	half = r->count / 2;
	gap.us = r->rows[0].us;
	gap.value = r->rows[half].us;
	if (last)
		find_last(r, half, last, key_count);
	for (uint32_t i = 0; i < half; i++) {
		struct history_row *row = &r->rows[i];

		if (last && row->kind == ROW_VALUE && last[row->key] == i + 1 && left < half / 2) {
			r->rows[left] = *row;
			r->rows[left++].us = gap.value;
		} else {
			free_row(r, row);
		}
	}
	free(last);
	r->dropped += half - left;
	r->rows[left++] = gap;
	memmove(r->rows + left, r->rows + half, (r->count - half) * sizeof(*r->rows));
	r->count -= half - left;
	rows_sort(r);
}

void rows_add(struct history_rows *r, struct history_row row, uint32_t key_count)
{
	size_t bytes = row.text ? strlen(row.text) + 1 : row.event ? sizeof(*row.event) : 0;

	while (r->count > 8 && (r->count + 1 >= r->most || r->text_bytes + bytes > r->text_most))
		drop_half(r, key_count);
	row.seq = r->seq++;
	r->text_bytes += bytes;
	r->rows[r->count++] = row;
}
