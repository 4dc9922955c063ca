/* SPDX-License-Identifier: MIT */
/* Entries of both journals, alarms and commands, merged by time; and how one is shown. */
#pragma once

#include <stdbool.h>

#include "src/faces/show/json.h"
#include "src/faces/show/when.h"
#include "src/ground/signal/value.h"
#include "src/public/ows.h"

struct journal_entry {
	int64_t when_ns;  /* boot time; of an earlier boot as if this one had begun before it */
	const char *name; /* of the signal; valid until the handle that it is from is used again */
	int decimals;     /* of the signal; -1: not known */
	int signal;
	uint32_t number; /* in its journal; of the past: in the order of reading */
	bool is_command;
	bool past;      /* it was read from disk: without number and `more` */
	bool this_boot; /* when_ns is of the boot that this machine is in */
	union {
		struct ows_alarm alarm;
		struct ows_commanded command;
	};
};

/* The entries from two numbers on. */
struct journal_entries {
	struct journal_entry *entry;
	unsigned count;
	uint32_t next_alarm, next_command; /* where the next look begins */
	bool begun;                        /* these numbers are of this start of owsd */
};

/* Get what is new since the last look, all that is kept at the first. false: no memory. */
bool journal_look(struct ows *h, char *const *patterns, int count, struct journal_entries *entries);
/* Put all of `more` among them, in the order of time. false: no memory. */
bool journal_add(struct journal_entries *entries, const struct journal_entries *more);
/* The order of entries, as for qsort(): earlier boots, then time; those of disk first. */
int journal_order(const void *a, const void *b);
void journal_free(struct journal_entries *entries);

#define JOURNAL_EVENT 64
/* "high raised", "SafeValue". */
const char *journal_event(const struct journal_entry *entry, char text[JOURNAL_EVENT]);
/* The value, with at most so many decimals (-1: all); NULL: the entry has none, or a text. */
const char *journal_value(const struct journal_entry *entry, int decimals,
                          char text[VALUE_TEXT_MAX]);
/* Did a program or a person do it? An alarm is raised, and returns, by itself. */
bool journal_is_deed(const struct journal_entry *entry);
const struct ows_by *journal_by(const struct journal_entry *entry);
/* As an object; for a browser numbers as json_exact() has them. */
void journal_json(struct json *json, const struct when *now, const struct journal_entry *entry,
                  bool browser);
