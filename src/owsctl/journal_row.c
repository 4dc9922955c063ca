/* SPDX-License-Identifier: MIT */
/* An entry of a journal as a row of a table. */
#include <stdio.h>

#include "src/owsctl/journal_row.h"
#include "src/show/who.h"

/* clang-format off */
const struct table_column journal_columns[JOURNAL_COLUMNS] = {
	{"TIME"}, {"NAME"}, {"EVENT"}, {"VALUE", .right = true, .most = 40}, {"PROGRAM"}, {"USER"},
	{"FOR"}, {"REMARK"},
};
/* clang-format on */

bool journal_row(struct table *table, const struct when *now, const struct journal_entry *entry)
{
	char time[WHEN_TEXT], event[JOURNAL_EVENT], value[VALUE_TEXT_MAX], more[32] = "";
	char program[WHO_TEXT] = "-", user[WHO_TEXT] = "-";
	const char *shown = journal_value(entry, entry->decimals, value), *person = "", *remark;

	if (journal_is_deed(entry)) {
		who_program(journal_by(entry), program);
		who_user(journal_by(entry), user);
		person = journal_by(entry)->person;
	}
	remark = entry->is_command ? more : entry->alarm.text;
	if (entry->is_command && entry->command.more)
		snprintf(more, sizeof(more), "after %u more", (unsigned)entry->command.more);
	if (entry->is_command && entry->command.type == OWS_STRING)
		shown = entry->command.text;
	return table_add(table,
	                 (const char *const[]){when_iso(now, entry->when_ns, time), entry->name,
	                                       journal_event(entry, event), shown ? shown : "-",
	                                       program, user, *person ? person : "-", remark});
}
