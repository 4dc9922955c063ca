/* SPDX-License-Identifier: MIT */
/*
 * The file of history: one SQLite database for an instance of owsd. The recorder alone writes it.
 *
 * Rows have a time as their number (id): microseconds that never go back, neither when the clock is
 * set nor over a restart. They are boot time plus a number of the session, which is a run of the
 * recorder; a session says which date its ids stand for (id + date = microseconds since 1970). So a
 * clock that is late, or that is set, changes rows of sessions and no value; and rows are appended,
 * which a card survives. Without an error of the clock ids are microseconds since 1970.
 *
 *     session  a run of the recorder: from which id, in which boot, and the date
 *     signal   names and units; what each is known by over another name (identity), and the names
 *              that it had (former). A signal of an earlier table whose name another has now has
 *              its identity for a name
 *     raw      a signal has a value from id on; repeated each hour, so that what held at a time is
 *              found in the hour before it
 *     gap      nothing is known from start on, of a signal or (0) of all
 *     event    commands and alarms with their program; steps of the clock; time may be before id
 *     minute, hour  of each signal least, most, mean and last good value, seconds good and known,
 *              number of rows, quality at the end (null: not known) and the worst one. The id is
 *              minute: its number (of ids) times 65536, plus the signal; hour: the number of eight
 *              hours times 65536, plus the signal, times eight, plus which of them it is, so that a
 *              year of a signal is in fewer pages. The row of the last minute of an hour has all
 *              its minutes as one text (minutes, src/history/file/minutes.h), and no sum of its
 *              own; an older file, and a signal whose values do not fit, has a row for each minute.
 *              A minute in which nothing came is in neither: the value held.
 *     trend and other views  the same with names, ISO times and words: src/history/file/views.h
 */
#pragma once

#include <sqlite3.h>
#include <stdint.h>

#include "src/history/file/views.h"

#define HISTORY_FILE "history.sqlite"
#define HISTORY_SCHEMA 6               /* user_version */
#define HISTORY_SCHEMA_READ 2          /* what a reader needs is the same since then */
#define HISTORY_SCHEMA_IDENTITY 4      /* since then a signal has one */
#define HISTORY_APPLICATION 0x6f777364 /* application_id: "owsd" */

#define MINUTE_US INT64_C(60000000)
#define HOUR_US (60 * MINUTE_US)
/* A value that holds has a row in this time, or is not known. */
#define LOOK_BACK_US (HOUR_US + 5 * MINUTE_US)
#define REPEAT_US HOUR_US

static inline int64_t schema_minute(int64_t minute, uint32_t signal)
{
	return minute << 16 | signal;
}
/* The row that has all minutes of an hour: that of the last one. */
static inline int64_t schema_minutes(int64_t hour, uint32_t signal)
{
	return schema_minute(hour * 60 + 59, signal);
}
static inline int64_t schema_hour(int64_t hour, uint32_t signal)
{
	return ((hour >> 3) << 16 | signal) << 3 | (hour & 7);
}
/* The id at which the hours that have rows end. */
#define SCHEMA_HOURS_END \
	"select (max(" SCHEMA_HOUR("id") ") + 1) * 3600000000 from hour" \
					 " where id >= (select max(id) >> 19 << 19 from hour)"

/*
 * Open for writing; make the tables, or bring older ones up to date. 0; -EBADMSG: damaged, or no
 * database; -EPROTONOSUPPORT: newer than HISTORY_SCHEMA; -EEXIST: of another program; or the error
 * of the disk. *db is NULL unless 0 is returned.
 */
int schema_open(const char *path, sqlite3 **db);
