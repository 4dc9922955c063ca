/* SPDX-License-Identifier: MIT */
/*
 * What is to be told: entries in the order in which they came, counted from 0. The last ones are
 * kept; who reads them knows his own place, so that a reader who is held up holds up no other.
 */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#define QUEUE_ENTRIES 256
#define ENTRY_TEXT 512

struct entry {
	int64_t came_ns, entered_ns; /* here; it, or what it escalates, in owsd's journal; 0: no */
	bool critical, escalated;
	unsigned head;         /* bytes of text up to its first ';', for a title */
	char text[ENTRY_TEXT]; /* one line, printable */
};
struct queue {
	struct entry entries[QUEUE_ENTRIES];
	uint64_t first, end; /* the oldest that is kept; the next one */
};

/*
 * The number of the one that goes if one more comes: the oldest that is not critical, or the
 * oldest. end: there is place.
 */
uint64_t queue_leaves(const struct queue *queue);
/* Place for one more. Of those older than the one that goes each gets the next number. */
struct entry *queue_add(struct queue *queue);
/* NULL: not there yet, or not kept. */
const struct entry *queue_at(const struct queue *queue, uint64_t number);
/*
 * When the oldest entry from number on was entered in the journal; INT64_MAX: none was. Of those
 * that are escalated, or of the others.
 */
int64_t queue_oldest(const struct queue *queue, uint64_t number, bool escalated);
