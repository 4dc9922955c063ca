/* SPDX-License-Identifier: MIT */
/*
 * How long rows are kept. Ages are counted in ids, which stand still while no recorder runs: so
 * nothing is deleted too early. The file does not become smaller, what is free in it is used again.
 */
#include "src/history/file/keep.h"

#include <stdbool.h>
#include <stddef.h>
#include <sys/statvfs.h>

#include "src/history/file/schema.h"
#include "src/history/file/sql.h"

#define DAY_US (24 * HOUR_US)
#define LEAST_US (7 * DAY_US) /* stays, however little room others have */
#define ROWS 20000            /* of each table with a commit: far more than come */

/* The oldest rows whose column `id` is before that. */
static int delete_before(sqlite3 *db, const char *table, const char *id, int64_t before)
{
	char text[192];
	sqlite3_stmt *statement;
	int err;

	sqlite3_snprintf(sizeof(text), text,
	                 "delete from %s where %s in"
	                 " (select %s from %s where %s < ? order by %s limit %d)",
	                 table, id, id, table, id, id, ROWS);
	err = sql_errno(db, sqlite3_prepare_v2(db, text, -1, &statement, NULL));
	if (err)
		return err;
	err = sql_run(statement, "i", before);
	sqlite3_finalize(statement);
	return err;
}

/* As long as the journal, which shows them; but no value holds across one that is gone. */
static int delete_gaps(sqlite3 *db, int64_t before)
{
	int64_t value = INT64_MAX;
	int got = sql_ask(db, "select min(id) from raw", &value);

	return got < 0 ? got : delete_before(db, "gap", "start", value < before ? value : before);
}

/* Of the oldest row: sums count from the begin of the row that has them. Else the newest. */
static const char oldest_run[] =
	"select max(start) from session where start <= (select min(id) from ("
	"select min(id) as id from raw union all select min(start) from gap"
	" union all select min(id) from event"
	" union all select ((min(id) >> 16) - 59) * 60000000 from minute"
	" union all select (min(id) >> 19) * 8 * 3600000000 from hour"
	" union all select max(start) from session))";

/* A run of the recorder says what the ids of rows mean until the next one begins. */
static int delete_runs(sqlite3 *db)
{
	int64_t run = 0;
	int got = sql_ask(db, oldest_run, &run);

	return got < 0 ? got : delete_before(db, "session", "start", run);
}

static int64_t oldest_kept(int64_t last_id, uint32_t days)
{
	return days ? last_id - days * DAY_US : 0;
}

/* Is the file, without what is free in it, larger than it may be? */
static int is_too_large(const struct history_keep *keep, sqlite3 *db, bool *large)
{
	int64_t pages = 0, spare = 0, size = 0;
	int err = sql_ask(db, "pragma page_count", &pages);

	*large = false;
	if (!keep->bytes)
		return 0;
	if (err >= 0)
		err = sql_ask(db, "pragma freelist_count", &spare);
	if (err >= 0)
		err = sql_ask(db, "pragma page_size", &size);
	*large = (uint64_t)((pages - spare) * size) > keep->bytes;
	return err < 0 ? err : 0;
}

static bool is_disk_full(const struct history_keep *keep, const char *directory)
{
	struct statvfs disk;

	return keep->spare && statvfs(directory, &disk) == 0 &&
	       (uint64_t)disk.f_bavail * disk.f_frsize < keep->spare;
}

static int64_t oldest(sqlite3 *db, const char *text)
{
	int64_t id = INT64_MAX;

	return sql_ask(db, text, &id) < 0 ? INT64_MAX : id;
}

int keep_delete(const struct history_keep *keep, sqlite3 *db, const char *directory,
                int64_t last_id)
{
	int64_t raw = oldest_kept(last_id, keep->days);
	int64_t minutes = oldest_kept(last_id, keep->minutes);
	int64_t hours = oldest_kept(last_id, keep->hours);
	bool large;
	int err = is_too_large(keep, db, &large);

	if (err)
		return err;
	if (large || is_disk_full(keep, directory)) {
		int64_t spared = last_id - (large ? DAY_US : LEAST_US);

		/* values first; once there is little of them, minutes too */
		raw = spared > raw ? spared : raw;
		if (large && oldest(db, "select min(id) from raw") > spared - DAY_US &&
		    minutes < last_id - LEAST_US)
			minutes = last_id - LEAST_US;
	}
	err = raw > 0 ? delete_before(db, "raw", "id", raw) : 0;
	if (!err && minutes > 0)
		err = delete_before(db, "minute", "id", minutes / MINUTE_US << 16);
	if (!err && minutes > 0)
		err = delete_before(db, "event", "id", minutes);
	if (!err && minutes > 0)
		err = delete_gaps(db, minutes);
	if (!err && hours > 0)
		err = delete_before(db, "hour", "id",
		                    schema_hour(hours / HOUR_US & ~INT64_C(7), 0));
	return err ? err : delete_runs(db);
}
