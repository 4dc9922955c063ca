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
#include "src/history/file/wal_lock.h"

#define BUSY_MS 200
#define LOG_BYTES 4194304
#define LOG_ROOM (64u << 20) /* on the disk */
#define LOG_PATH 400

/* real: a whole number takes a byte or two of the file, and a query that divides gets a fraction */
#define ROLLUP(name) \
	"create table " name " (id integer primary key, least real, most real, mean real," \
	" last real, good real, known real, count, quality, worst);"

/* Words for numbers */
#define WORDS(name) \
	"create table if not exists " name " (" name " integer primary key, text text not null);"

#define EVENT_WORDS WORDS("alarm_kind") WORDS("alarm_event") WORDS("command_reason")

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
	ROLLUP("minute") ROLLUP("hour") EVENT_WORDS;
/* clang-format on */

/* Step i makes tables of version i those of version i + 1. The views are made anew after all. */
static const char *const steps[HISTORY_SCHEMA] = {
	/* an hour had the id number * 65536 + signal */
	[1] = "alter table hour rename to hours; " ROLLUP(
		"hour") "insert into hour select (((id >> 19 << 16) | (id & 65535)) << 3) | ((id >> 16) & 7), least,"
			" most, mean, last, good, known, count, quality, worst from hours;"
			"drop table hours;",
	/* of an event there was no word for what it is */
	[2] = EVENT_WORDS,
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
	[4] = "alter table minute add column minutes text;"
	      "delete from minute where id >= (coalesce((" SCHEMA_HOURS_END
	      "), 0) / 60000000) << 16;",
	/* no view had days */
	[5] = "",
};

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
		for (int n = words[i].first; !err && n < words[i].end; n++)
			err = sql_run(statement, "it", (int64_t)n, words[i].text((uint8_t)n));
		sqlite3_finalize(statement);
	}
	return err;
}

static int migrate(sqlite3 *db, int64_t version)
{
	int err = sql_exec(db, "begin immediate");

	if (!err)
		err = views_drop(db);
	if (!err && version == 0)
		err = sql_exec(db, create);
	for (int64_t i = version ? version : CREATED; !err && i < HISTORY_SCHEMA; i++)
		err = sql_exec(db, steps[i]);
	if (!err)
		err = views_make(db);
	if (!err)
		err = add_words(db);
	if (!err)
		err = sql_exec(db, "pragma application_id = 1870099300; pragma user_version = 6");
	if (!err)
		err = sql_exec(db, "commit");
	if (err)
		sqlite3_exec(db, "rollback", NULL, NULL, NULL);
	return err;
}

_Static_assert(HISTORY_APPLICATION == 1870099300 && HISTORY_SCHEMA == 6,
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
