/* SPDX-License-Identifier: MIT */
/* Entries of both journals, alarms and commands, merged by time; and how one is shown. */
#ifndef OWSCTL_JOURNAL_ENTRY_H
#define OWSCTL_JOURNAL_ENTRY_H

#include <stdbool.h>

#include "src/libows/ows.h"
#include "src/owsctl/json.h"
#include "src/owsctl/table.h"
#include "src/owsctl/when.h"

struct journal_entry {
	int64_t when_ns;
	int signal;
	uint32_t number;
	bool is_command;
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
void journal_free(struct journal_entries *entries);

extern const struct table_column journal_columns[];
#define JOURNAL_COLUMNS 8
bool journal_row(struct table *table, struct ows *h, const struct when *now,
                 const struct journal_entry *entry);
void journal_json(struct json *json, struct ows *h, const struct when *now,
                  const struct journal_entry *entry);

#endif
