/* SPDX-License-Identifier: MIT */
/*
 * Sets of what is due, as bits under a summary of words that are not empty, and the wheel, as lists
 * of rows by the period that they wait for.
 */
#include <assert.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "src/daemon/engine/due.h"

static uint32_t words_for(uint32_t bits)
{
	return bits / 32 + (bits % 32 != 0);
}

int due_set_init(struct due_set *set, uint32_t size)
{
	uint32_t words = words_for(size);

	*set = (struct due_set){.size = size};
	set->word = calloc(words + 1, sizeof(*set->word));
	set->summary = calloc(words_for(words) + 1, sizeof(*set->summary));
	if (!set->word || !set->summary) {
		due_set_free(set);
		return -ENOMEM;
	}
	return 0;
}

void due_set_free(struct due_set *set)
{
	free(set->word);
	free(set->summary);
	*set = (struct due_set){0};
}

bool due_set_has(const struct due_set *set, uint32_t row)
{
	assert(row < set->size);
	return set->word[row / 32] >> (row % 32) & 1;
}

void due_set_add(struct due_set *set, uint32_t row)
{
	if (due_set_has(set, row))
		return;
	set->word[row / 32] |= 1u << (row % 32);
	set->summary[row / 32 / 32] |= 1u << (row / 32 % 32);
	set->count++;
}

void due_set_remove(struct due_set *set, uint32_t row)
{
	if (!due_set_has(set, row))
		return;
	set->word[row / 32] &= ~(1u << (row % 32));
	if (!set->word[row / 32])
		set->summary[row / 32 / 32] &= ~(1u << (row / 32 % 32));
	set->count--;
}

/* First row of the set in from .. size - 1, -1 if there is none. */
static int64_t first_from(const struct due_set *set, uint32_t from)
{
	uint32_t words = words_for(set->size), w = from / 32, bits;

	if (from >= set->size)
		return -1;
	bits = set->word[w] & (UINT32_MAX << (from % 32));
	if (bits)
		return (int64_t)w * 32 + __builtin_ctz(bits);
	w++;
	while (w < words) {
		bits = set->summary[w / 32] & (UINT32_MAX << (w % 32));
		if (bits) {
			w = w / 32 * 32 + (uint32_t)__builtin_ctz(bits);
			return (int64_t)w * 32 + __builtin_ctz(set->word[w]);
		}
		w = (w / 32 + 1) * 32;
	}
	return -1;
}

int64_t due_set_next(const struct due_set *set)
{
	int64_t row;

	if (!set->count)
		return -1;
	row = first_from(set, set->cursor);
	return row >= 0 ? row : first_from(set, 0);
}

void due_set_take(struct due_set *set, uint32_t row)
{
	due_set_remove(set, row);
	set->cursor = row + 1 < set->size ? row + 1 : 0;
}

int due_wheel_init(struct due_wheel *wheel, uint32_t size, uint64_t period)
{
	wheel->period = period;
	wheel->size = size;
	for (unsigned i = 0; i < DUE_BUCKETS; i++)
		wheel->bucket[i] = DUE_NONE;
	memset(wheel->used, 0, sizeof(wheel->used));
	wheel->wait = calloc((size_t)size + 1, sizeof(*wheel->wait));
	return wheel->wait ? 0 : -ENOMEM;
}

void due_wheel_free(struct due_wheel *wheel)
{
	free(wheel->wait);
	wheel->wait = NULL;
}

void due_wheel_cancel(struct due_wheel *wheel, uint32_t row)
{
	struct due_wait *w;
	uint32_t bucket;

	assert(row < wheel->size);
	w = &wheel->wait[row];
	if (!w->waits)
		return;
	bucket = (uint32_t)(w->period % DUE_BUCKETS);
	if (w->prev != DUE_NONE)
		wheel->wait[w->prev].next = w->next;
	else
		wheel->bucket[bucket] = w->next;
	if (w->next != DUE_NONE)
		wheel->wait[w->next].prev = w->prev;
	w->waits = false;
	if (wheel->bucket[bucket] == DUE_NONE)
		wheel->used[bucket / 32] &= ~(1u << (bucket % 32));
}

void due_wheel_at(struct due_wheel *wheel, uint32_t row, uint64_t period)
{
	struct due_wait *w;
	uint32_t *head;

	due_wheel_cancel(wheel, row);
	if (period <= wheel->period)
		period = wheel->period + 1;
	w = &wheel->wait[row];
	head = &wheel->bucket[period % DUE_BUCKETS];
	*w = (struct due_wait){.period = period, .next = *head, .prev = DUE_NONE, .waits = true};
	if (*head != DUE_NONE)
		wheel->wait[*head].prev = row;
	*head = row;
	wheel->used[period % DUE_BUCKETS / 32] |= 1u << (period % 32);
}

void due_wheel_advance(struct due_wheel *wheel, uint64_t period, due_ready *ready, void *ctx)
{
	uint64_t turns = period > wheel->period ? period - wheel->period : 0;
	uint64_t first = wheel->period + 1;

	if (turns > DUE_BUCKETS)
		turns = DUE_BUCKETS;
	if (period > wheel->period)
		wheel->period = period;
	for (uint64_t i = 0; i < turns; i++) {
		uint32_t row = wheel->bucket[(first + i) % DUE_BUCKETS];

		while (row != DUE_NONE) {
			uint32_t next = wheel->wait[row].next;

			if (wheel->wait[row].period <= period) {
				due_wheel_cancel(wheel, row);
				ready(ctx, row);
			}
			row = next;
		}
	}
}

uint64_t due_wheel_next(const struct due_wheel *wheel, uint64_t after, uint64_t most)
{
	uint64_t period = after + 1;

	assert(most - after < DUE_BUCKETS);
	while (period < most) {
		uint32_t bits = wheel->used[period % DUE_BUCKETS / 32] >> (period % 32);

		if (bits) {
			period += (uint32_t)__builtin_ctz(bits);
			break;
		}
		period += 32 - period % 32;
	}
	return period < most ? period : most;
}
