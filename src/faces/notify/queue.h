/* SPDX-License-Identifier: MIT */
/*
 * What is to be told: entries in the order in which they came, counted from 0. The last ones are
 * kept; who reads them knows his own place, so that a reader who is held up holds up no other.
 */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "src/public/ows.h"

/* Which alarms are told, how severe they are, and when they wait. Pure. */

/* Above LimitHH, below LimitLL, and what a device reports by itself. */
bool rules_critical(const struct ows_alarm *alarm);
/* Is it a kind of limit alarm, of which a signal has one? */
bool rules_of_limit(uint8_t kind);
/* Does it wake people? That a critical one has returned does not. */
bool rules_urgent(const struct ows_alarm *alarm);
/* Is the signal meant? The last pattern that fits decides; !PATTERN: it is not. */
bool rules_chosen(const char *patterns, const char *name);
/* Is that minute of the day in the hours, which may go over midnight? NULL: there are none. */
bool rules_quiet(const char *hours, unsigned minute);

#define QUEUE_ENTRIES 256
#define ENTRY_TEXT 768

/* What an entry tells that may end before it is told: an enum ows_alarm_kind, or */
#define ENTRY_BAD 64     /* a value that stays bad */
#define ENTRY_NO_OWSD 65 /* no owsd runs */

struct entry {
	int64_t came_ns, entered_ns; /* here; it, or what it escalates, in owsd's journal; 0: no */
	int64_t since_ns;            /* the time in its text */
	int64_t ended_ns;            /* when it ended; 0: it has not, as far as is known */
	const char *ended;           /* how: "returned" */
	uint64_t print;              /* of the signal's identity */
	int signal;                  /* its index; -1: it is about none */
	uint8_t kind;                /* of what may end; 0: nothing does */
	bool critical, escalated;
	bool severe;           /* it is told with Least "critical" too */
	unsigned head;         /* bytes of text up to its first ';', for a title */
	unsigned at;           /* where since_ns stands in the text; 0: nowhere */
	unsigned len;          /* bytes of text without how it ended */
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
struct entry *queue_at(struct queue *queue, uint64_t number);
/*
 * When the oldest entry from number on was entered in the journal; INT64_MAX: none was. Of those
 * that are escalated, or of the others.
 */
int64_t queue_oldest(const struct queue *queue, uint64_t number, bool escalated);
/*
 * What entries of that signal (-1: of none) and kind tell has ended so and then. The kinds of
 * limits end together.
 */
void queue_ended(struct queue *queue, int signal, uint8_t kind, const char *how, int64_t ended_ns);
