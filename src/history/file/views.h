/* SPDX-License-Identifier: MIT */
/*
 * What a person reads of the file: rows with names, ISO times and words. docs/history-queries.md
 * has queries of them.
 *
 *     day     of each date (UTC) and session: the first id, the id after the last one, and the date
 *             of the session. A view that has the column day is read by that alone where a query
 *             names days, and whole where it does not: no time in words has an index
 *     trend   values, and gaps: that of all signals is a row of each. id says which row is later
 *     trend_minute, trend_hour  sums
 *     trend_event  commands, alarms, steps of the clock
 *     trend_alarm  alarms that were raised, and when each ended or was raised anew
 */
#pragma once

#include <sqlite3.h>

/* The number of an hour, by the id of its row, in SQL. */
#define SCHEMA_HOUR(id) "((" id " >> 19 << 3) + (" id " & 7))"

int views_drop(sqlite3 *db);
int views_make(sqlite3 *db);
