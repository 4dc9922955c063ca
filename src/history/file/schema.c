/* SPDX-License-Identifier: MIT */
/* The tables of the file, and how an older file becomes one of this version. */
#include "src/history/file/schema.h"

#include <errno.h>
#include <fcntl.h>
#include <stddef.h>
#include <stdio.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include "src/history/file/record.h"
#include "src/history/file/sql.h"
#include "src/history/file/tables.h"
#include "src/history/file/wal_lock.h"

#define BUSY_MS 200
#define LOG_BYTES 4194304
#define LOG_ROOM (64u << 20) /* on the disk */
#define LOG_PATH 400

#define ISO(id) "strftime('%Y-%m-%dT%H:%M:%fZ', (" id " + date) / 1000000.0, 'unixepoch')"
#define SESSION(id) \
	"join session on session.start = " \
	"(select max(start) from session where start <= " id ")"
/* Rows with t.id, least and so on; the number of their minute or hour, and their signal. */
#define ROLLUP_VIEW(name, rows, us, number, signals) \
	"create view trend_" name " as select " ISO( \
		number \
		" * " us) " as time, name, least," \
			  " most, mean, last, unit, good, known, count, q.text as quality, w.text as worst" \
			  " from " rows " t join signal on signal.signal = " signals " & 65535" \
			  " left join quality q on q.quality = t.quality left join quality w on w.quality = t.worst" \
			  " " SESSION(number " * " us " + " us " - 1") ";"
/* real: a whole number takes a byte or two of the file, and a query that divides gets a fraction */
#define ROLLUP(name) \
	"create table " name " (id integer primary key, least real, most real, mean real," \
	" last real, good real, known real, count, quality, worst);"

/* Words for numbers */
#define WORDS(name) \
	"create table if not exists " name " (" name " integer primary key, text text not null);"

/* clang-format off */
#define EVENTS \
	WORDS("alarm_kind") WORDS("alarm_event") WORDS("command_reason") \
	"create view trend_event as select " ISO("event.time") " as time," \
	" case event.kind when 6 then 'clock' when 7 then 'command' else 'alarm' end as kind," \
	" case when event.kind <> 6 then coalesce(c.text, ltrim(coalesce(k.text, '') || ' ' || a.text))" \
	" when value <> 0 then 'set' when value = 0 then 'trust changed' end as what, name, value," \
	" before, case event.kind when 6 then 's' else unit end as unit, q.text as quality, event.text, program, person" \
	" from event left join signal using (signal) left join quality q" \
	" on q.quality = event.quality left join command_reason c" \
	" on event.kind = 7 and command_reason = event.reason left join alarm_kind k" \
	" on event.kind = 8 and alarm_kind = event.reason left join alarm_event a" \
	" on event.kind = 8 and alarm_event = event.event " SESSION("event.id") ";"
/* clang-format on */

/*
 * An hour of minutes as rows, as src/history/file/minutes.h has them: what is missing at the end of
 * one is what it mostly is. A row of a sum has a count.
 */
/* clang-format off */
#define FIELD(at, name) " json_extract(value, '$[" at "]') as " name
#define VALUE(field) " (base + step * coalesce(" field ", last)) / 1e6,"
#define MINUTE_ROWS \
	"(select id, least, most, mean, last, good, known, count, quality, worst" \
	" from minute where count is not null union all select" \
	" ((id >> 16) - 59 + minute) << 16 | (id & 65535)," \
	VALUE("least") VALUE("most") VALUE("mean / 1000.0") VALUE("last") \
	" coalesce(good / 1e6, 60.0), coalesce(known / 1e6, 60.0), count," \
	" nullif(coalesce(quality, 192), -1), nullif(coalesce(worst, 192), -1) from (select" \
	" minute.id as id, json_extract(minutes, '$[0]') as base," \
	" json_extract(minutes, '$[1]') as step," \
	FIELD("0", "minute,") FIELD("1", "count,") FIELD("2", "last,") FIELD("3", "least,") \
	FIELD("4", "most,") FIELD("5", "mean,") FIELD("6", "good,") FIELD("7", "known,") \
	FIELD("8", "quality,") FIELD("9", "worst") \
	" from minute, json_each(minutes) where key > 1))"
/* clang-format on */
#define HOURS \
	ROLLUP("hour") \
	ROLLUP_VIEW("hour", "hour", "3600000000", SCHEMA_HOUR("t.id"), "(t.id >> 3)")

/* An empty file becomes one of version 3. */
#define CREATED 3
static const char create[] =
	/* clang-format off */
	"create table session (start integer primary key, boot integer not null,"
	" base integer not null, date integer not null, trusted integer not null, seen integer);"
	"create table signal (signal integer primary key, name text not null unique,"
	" unit text not null, type integer not null, output integer not null,"
	" decimals integer not null);"
	"create table raw (id integer primary key, signal integer not null, value,"
	" quality integer not null);"
	"create table gap (start integer not null, signal integer not null, until integer,"
	" reason integer not null, primary key (start, signal)) without rowid;"
	"create table event (id integer primary key, time integer not null, kind integer not null,"
	" signal integer, type integer, quality integer, reason integer, event integer, value,"
	" before, text text, serial integer, uid integer, pid integer, program text, person text);"
	"create index event_time on event (time);"
	WORDS("quality") WORDS("reason") /* of gaps */
	/* a number that is not good could be believed */
	"create view trend as select " ISO("raw.id") " as time, name,"
	" case when raw.quality >= 192 then value end as value, unit, q.text as quality"
	" from raw join signal using (signal) left join quality q on q.quality = raw.quality "
	SESSION("raw.id")
	" union all select " ISO("gap.start") ", coalesce(name, '*'), null, unit, r.text"
	" from gap left join signal using (signal) left join reason r on r.reason = gap.reason "
	SESSION("gap.start") ";"
	ROLLUP("minute")
	HOURS EVENTS;
/* clang-format on */

/* Step i makes a file of version i one of version i + 1. */
static const char *const steps[HISTORY_SCHEMA] = {
	/* an hour had the id number * 65536 + signal */
	[1] = "drop view trend_hour; alter table hour rename to hours; " HOURS
	      "insert into hour select (((id >> 19 << 16) | (id & 65535)) << 3) | ((id >> 16) & 7), least,"
	      " most, mean, last, good, known, count, quality, worst from hours;"
	      "drop table hours;",
	/* of an event there was no word for what it is */
	[2] = "drop view trend_event; " EVENTS,
	/*
         * A signal was its name: the recorder gives it an identity when it finds it by that. former
         * has the names before, as " hall attic ".
         */
	[3] = "alter table signal add column identity text;"
	      "alter table signal add column former text not null default ' ';"
	      "create unique index signal_identity on signal (identity);",
	/*
	 * Each minute had a row of its own: these stay. Those of the hour under way are made again,
	 * as one text with the others of that hour.
	 */
	[4] = "drop view if exists trend_minute; alter table minute add column minutes text;"
	      "drop view trend_event; " EVENTS
	      "delete from minute where id >= (coalesce((" SCHEMA_HOURS_END
	      "), 0) / 60000000) << 16;" ROLLUP_VIEW("minute", MINUTE_ROWS, "60000000",
                                                     "(t.id >> 16)", "t.id"),
};

_Static_assert(OWS_HISTORY_CLOCK == 6 && OWS_HISTORY_COMMAND == 7 && OWS_HISTORY_ALARM == 8,
               "trend_event has these numbers");

static const struct {
	const char *insert;
	int first, end;
	const char *(*text)(uint8_t number);
} words[] = {
	{"insert or ignore into quality values (?, ?)", 0, 256, ows_quality_text},
	{"insert or ignore into reason values (?, ?)", 0, HISTORY_REASONS, history_reason_text},
	{"insert or ignore into alarm_kind values (?, ?)", OWS_ALARM_DEVICE, OWS_ALARM_DIFFERS + 1,
         ows_alarm_kind_text},
	{"insert or ignore into alarm_event values (?, ?)", OWS_ALARM_RAISED, OWS_ALARM_FAILED + 1,
         ows_alarm_event_text},
	{"insert or ignore into command_reason values (?, ?)", OWS_REASON_NONE, OWS_REASON_LAST + 1,
         ows_reason_text},
};

static int add_words(sqlite3 *db)
{
	int err = 0;

	for (size_t i = 0; !err && i < sizeof(words) / sizeof(words[0]); i++) {
		sqlite3_stmt *statement;

		err = sql_errno(db, sqlite3_prepare_v2(db, words[i].insert, -1, &statement, NULL));
		for (int n = words[i].first; !err && n < words[i].end; n++) {
			sql_bind(statement, "it", (int64_t)n, words[i].text((uint8_t)n));
			err = sql_next(statement);
		}
		sqlite3_finalize(statement);
	}
	return err;
}

static int migrate(sqlite3 *db, int64_t version)
{
	int err = sql_exec(db, "begin immediate");

	if (!err && version == 0)
		err = sql_exec(db, create);
	for (int64_t i = version ? version : CREATED; !err && i < HISTORY_SCHEMA; i++)
		err = sql_exec(db, steps[i]);
	if (!err)
		err = add_words(db);
	if (!err)
		err = sql_exec(db, "pragma application_id = 1870099300; pragma user_version = 5");
	if (!err)
		err = sql_exec(db, "commit");
	if (err)
		sqlite3_exec(db, "rollback", NULL, NULL, NULL);
	return err;
}

_Static_assert(HISTORY_APPLICATION == 1870099300 && HISTORY_SCHEMA == 5,
               "migrate() says these in words");
_Static_assert(LOG_BYTES == 4194304, "schema_check() says this in words");

static int schema_check(sqlite3 *db)
{
	int64_t version = 0, application = 0, tables = 0;
	int err = sql_ask(db, "pragma user_version", &version);

	if (err >= 0)
		err = sql_ask(db, "pragma application_id", &application);
	if (err >= 0)
		err = sql_ask(db, "select count(*) from sqlite_master", &tables);
	if (err < 0)
		return err;
	if (tables && application != HISTORY_APPLICATION)
		return -EEXIST;
	if (version > HISTORY_SCHEMA)
		return -EPROTONOSUPPORT;
	/*
	 * Each commit is synced: a power cut costs what came after it, and a card that is pulled is
	 * noticed before memory forgets. ext4 writes as much without it, a little later. extra: the
	 * journal of the first step into WAL mode is gone for good, or it would undo all after it.
	 */
	err = sql_exec(db, "pragma synchronous = extra; pragma journal_mode = wal;"
	                   "pragma temp_store = memory; pragma journal_size_limit = 4194304");
	if (!err && version < HISTORY_SCHEMA)
		err = migrate(db, version);
	return err ? err : tables_check(db);
}

/*
 * SQLite's log of commits has its full size from the begin: a commit that makes it longer costs
 * five blocks of ext4's journal more. SQLite takes zeros for the end of the log, and empties it
 * where it closes the file. On a disk that is nearly full it grows as it would without.
 */
static void fill_log(const char *path)
{
	const char zeros[1 << 12] = {0};
	char name[LOG_PATH];
	struct statvfs disk;
	struct stat seen;
	int fd = -1;

	if (snprintf(name, sizeof(name), "%s-wal", path) < (int)sizeof(name))
		fd = open(name, O_WRONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
	if (fd < 0)
		return;
	if (fstat(fd, &seen) == 0 && S_ISREG(seen.st_mode) && fstatvfs(fd, &disk) == 0 &&
	    disk.f_bavail > LOG_ROOM / disk.f_frsize)
		while (seen.st_size < LOG_BYTES) {
			size_t left = (size_t)(LOG_BYTES - seen.st_size);
			ssize_t n = pwrite(fd, zeros, left < sizeof(zeros) ? left : sizeof(zeros),
			                   seen.st_size);

			if (n <= 0)
				break;
			seen.st_size += n;
		}
	close(fd);
}

int schema_open(const char *path, sqlite3 **db)
{
	int err, keep = 1;

	err = sqlite3_open_v2(path, db, SQLITE_OPEN_READWRITE | SQLITE_OPEN_NOMUTEX,
	                      wal_lock_vfs());
	err = sql_errno(*db, err);
	if (!err) {
		sqlite3_busy_timeout(*db, BUSY_MS);
		sqlite3_db_config(*db, SQLITE_DBCONFIG_ENABLE_TRIGGER, 0, NULL);
		/* readers that cannot write there need the two files beside it */
		sqlite3_file_control(*db, "main", SQLITE_FCNTL_PERSIST_WAL, &keep);
		err = schema_check(*db);
	}
	if (!err)
		fill_log(path);
	if (err) {
		sqlite3_close(*db);
		*db = NULL;
	}
	return err;
}
