/* SPDX-License-Identifier: MIT */
/* The signals of the image as owsd-notify knows them, and their move into those of another one. */
#include <stdlib.h>
#include <string.h>

#include "src/faces/notify/queue.h"
#include "src/faces/notify/rows.h"
#include "src/ground/signal/hash.h"

static int by_print(const void *a, const void *b)
{
	const struct row *one = a, *other = b;

	return (one->print > other->print) - (one->print < other->print);
}

static struct row *row_of(const struct rows *rows, uint64_t print)
{
	struct row key = {.print = print};

	return rows->count ? bsearch(&key, rows->row, (size_t)rows->count, sizeof(key), by_print)
	                   : NULL;
}

void rows_carry(struct rows *from, struct rows *to, struct queue *queue)
{
	struct row *row;

	for (int i = 0; i < from->count; i++)
		from->row[i].now = -1;
	if (from->count)
		qsort(from->row, (size_t)from->count, sizeof(*row), by_print);
	for (int i = 0; i < to->count; i++) {
		row = row_of(from, to->row[i].print);
		if (!row)
			continue;
		row->now = i;
		if (!to->row[i].chosen)
			continue;
		to->row[i].bad_ns = row->bad_ns;
		to->row[i].raised_ns = row->raised_ns;
		to->row[i].told = row->told;
	}
	for (uint64_t n = queue->first; n < queue->end; n++) {
		struct entry *entry = queue_at(queue, n);

		row = row_of(from, entry->print);
		if (entry->signal >= 0)
			entry->signal = row ? row->now : -1;
	}
}

bool rows_make(struct rows *rows, struct ows *ows, const struct config_notify *notify,
               struct queue *queue)
{
	struct rows fresh = {.count = ows_count(ows)};
	struct ows_info info;

	fresh.row = calloc((size_t)fresh.count + 1, sizeof(*fresh.row));
	if (!fresh.row)
		fresh.count = 0;
	for (int i = 0; i < fresh.count; i++)
		if (!ows_info(ows, i, &info)) {
			fresh.row[i].chosen = notify->given &&
			                      rules_chosen(notify->signals, info.name);
			fresh.row[i].print = hash_text(HASH_BEGIN, info.identity,
			                               strlen(info.identity));
		}
	rows_carry(rows, &fresh, queue);
	free(rows->row);
	*rows = fresh;
	return fresh.row;
}
