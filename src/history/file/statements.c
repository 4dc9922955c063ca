/* SPDX-License-Identifier: MIT */
/* The texts of the writer's statements. */
#include "src/history/file/statements.h"

#include <stddef.h>

#include "src/history/file/schema.h"
#include "src/history/file/sql.h"

#define ROLLUP_ROW "values (?, ?, ?, ?, ?, ?, ?, ?, ?, ?"
static const char *const texts[S_COUNT] = {
	[S_BEGIN] = "begin immediate",
	[S_COMMIT] = "commit",
	[S_ROLLBACK] = "rollback",
	/* a file that was made before there were identities has names alone */
	[S_FIND] = "select signal from signal where identity = ?1 union all"
		   " select signal from signal where identity is null and name = ?2 limit 1",
	[S_TAKE] = "update signal set name = coalesce(identity, '/' || signal)"
		   " where name = ?1 and signal <> ?2",
	[S_NAME] = "insert into signal (name, unit, type, output, decimals, identity)"
		   " values (?, ?, ?, ?, ?, ?)",
	[S_RENEW] = "update signal set former = former || case when name = ?1 or name like '/%'"
		    " or instr(former, ' ' || name || ' ') then '' else name || ' ' end,"
		    " name = ?1, unit = ?2, type = ?3, output = ?4, decimals = ?5, identity = ?6"
		    " where signal = ?7 and (name, unit, type, output, decimals, identity)"
		    " is not (?1, ?2, ?3, ?4, ?5, ?6)",
	[S_VALUE] = "insert into raw values (?, ?, ?, ?)",
	[S_GAP] = "insert into gap values (?, ?, ?, ?) on conflict do nothing",
	[S_LONGER] = "update gap set until = ?1 where start = ?2 and signal = 0",
	[S_END_GAP] = "update gap set until = ? where signal = 0 and until is null",
	[S_EVENT] = "insert into event values (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)",
	[S_MINUTE] = "insert or ignore into minute " ROLLUP_ROW ", null)",
	[S_MINUTES] = "insert or ignore into minute (id, minutes) values (?, ?)",
	[S_HOUR] = "insert or ignore into hour " ROLLUP_ROW ")",
	[S_SESSION] = "insert into session values (?, ?, ?, ?, ?, null)",
	[S_DATE] = "update session set date = ?1 - base, trusted = ?2 where boot = ?3"
		   " and (trusted = 0 or ?2) and (date <> ?1 - base or trusted <> ?2)",
	[S_SEEN] = "update session set seen = ? where start = ?",
	[S_LAST] = "select max((select coalesce(max(id), 0) from raw),"
		   " (select coalesce(max(start), 0) from gap),"
		   " (select coalesce(max(until), 0) from gap where signal = 0),"
		   " (select coalesce(max(id), 0) from event),"
		   " (select coalesce(max(max(start), coalesce(max(seen), 0)), 0) from session))",
	[S_OURS] = "select count(*) from session where start = ? and boot = ?",
	[S_BEFORE] = "select base, boot from session order by start desc limit 1",
	[S_SINCE] = "select coalesce((" SCHEMA_HOURS_END "),"
		    " (select min(start) from session), 0)",
	[S_REPLAY] = "select id, signal, value, quality from raw where id >= ?1"
		     " union all select start, signal, null, null from gap where start >= ?1"
		     " order by 1",
	[S_KNOWN] = "select max(time - base) from event join session on session.start ="
		    " (select max(start) from session where start <= id)"
		    " where id >= (select min(start) from session where boot = ?1)"
		    " and boot = ?1 and kind = ?2",
};

int statements_open(sqlite3 *db, sqlite3_stmt *statements[S_COUNT])
{
	int rc = SQLITE_OK;

	for (int i = 0; i < S_COUNT && rc == SQLITE_OK; i++)
		rc = sqlite3_prepare_v3(db, texts[i], -1, SQLITE_PREPARE_PERSISTENT, &statements[i],
		                        NULL);
	return sql_errno(db, rc);
}

void statements_close(sqlite3_stmt *statements[S_COUNT])
{
	for (int i = 0; i < S_COUNT; i++) {
		sqlite3_finalize(statements[i]);
		statements[i] = NULL;
	}
}
