/* SPDX-License-Identifier: MIT */
/* An entry of a journal as a row of a table. */
#ifndef OWSCTL_JOURNAL_ROW_H
#define OWSCTL_JOURNAL_ROW_H

#include "src/owsctl/table.h"
#include "src/show/journal_entry.h"

extern const struct table_column journal_columns[];
#define JOURNAL_COLUMNS 8
/* false: no memory. */
bool journal_row(struct table *table, const struct when *now, const struct journal_entry *entry);

#endif
