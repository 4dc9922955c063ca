/* SPDX-License-Identifier: MIT */
/* A history is found, opened for reading, looked at again and closed. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "src/history/file/place.h"
#include "src/history/file/schema.h"
#include "src/history/file/sql.h"
#include "src/history/library/open.h"
#include "src/memory/shm/segment.h"

/* The recorder's commits take less, and wait for no reader */
#define BUSY_MS 2000
/* A call may look at each row once: on a small machine two microseconds for its 26 bytes */
#define NS_PER_S INT64_C(1000000000)
#define LIMIT_NS (2 * NS_PER_S)
#define LIMIT_NS_PER_BYTE 100
#define PROGRESS 20000      /* steps of SQLite */
#define TEXT_MOST 1000000   /* bytes */
#define ROWS_MOST (1 << 20) /* of a list that is in memory */
#define URI (3 * HISTORY_PATH + 256)

static const char *const texts[H_COUNT] = {
	[H_RAW] = "select id, value, quality, null from raw where id <= ?1 and id >= ?2"
		  " and signal = ?3 order by id desc limit 1",
	[H_GAPS] = "select start, null, null, reason from gap where start <= ?1"
		   " and signal in (0, ?2) order by start desc limit 1",
	[H_STEPS] = "select id, value, quality, null from raw where id >= ?1 and id < ?2"
		    " and signal = ?3 union all select start, null, null, reason from gap"
		    " where start >= ?1 and start < ?2 and signal in (0, ?3) order by 1 limit ?4",
	[H_ALL] = "select id, value, quality, null, signal from raw where id >= ?1 and id < ?2"
		  " union all select start, null, null, reason, 0 from gap where start >= ?1"
		  " and start < ?2 and signal = 0 order by 1 limit ?3",
	/* an older file has no such column: the name is then that of the other row */
	[H_MINUTES] =
		"select (select minutes from minute where id = ?) from (select null as minutes)",
	[H_MINUTE] = "select least, most, mean, last, good, known, count, quality, worst"
		     " from minute where id = ?",
	[H_HOUR] = "select least, most, mean, last, good, known, count, quality, worst"
		   " from hour where id = ?",
	[H_EVENTS] = "select id, time, kind, signal, type, quality, reason, event, value, before,"
		     " text, serial, uid, pid, program, person, null from event"
		     " where id >= ?1 and id < ?2 and time >= ?3 and time < ?4"
		     " union all select start, start, case reason when 1 then 4 else 5 end, null,"
		     " null, null, reason, null, null, null, null, null, null, null, null, null,"
		     " until from gap where start >= ?1 and start < ?2 and start >= ?3"
		     " and start < ?4 and signal = 0 order by 1",
};

int ows_history_place(const char *instance, char *path, size_t size)
{
	char found[HISTORY_PATH];
	int err;

	instance = instance ? instance : "OWS";
	if (!segment_name_ok(instance))
		return -EINVAL;
	err = history_place_found(instance, found);
	if (err || strlen(found) >= size)
		return -ENOSPC;
	memcpy(path, found, strlen(found) + 1);
	return 0;
}

/* --- The file -------------------------------------------------------------------------------- */

static int64_t spent_ns(void)
{
	struct timespec now;

	clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
	return now.tv_sec * NS_PER_S + now.tv_nsec;
}

void open_allow(struct ows_history *h)
{
	h->until_ns = spent_ns() + LIMIT_NS + h->size * LIMIT_NS_PER_BYTE;
}

static int is_too_long(void *ctx)
{
	const struct ows_history *h = ctx;

	return spent_ns() > h->until_ns;
}

/* What the file could hold up, or run: nothing of it is believed. */
static void open_armed(struct ows_history *h)
{
	sqlite3_busy_timeout(h->db, BUSY_MS);
	sqlite3_db_config(h->db, SQLITE_DBCONFIG_DEFENSIVE, 1, NULL);
	sqlite3_db_config(h->db, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, NULL);
	sqlite3_db_config(h->db, SQLITE_DBCONFIG_ENABLE_VIEW, 0, NULL);
	sqlite3_limit(h->db, SQLITE_LIMIT_LENGTH, TEXT_MOST);
	sqlite3_progress_handler(h->db, PROGRESS, is_too_long, h);
}

/* A pipe among its files would be opened without an end. */
static int check_files(const struct ows_history *h)
{
	static const char *const beside[] = {"", "-journal", "-wal", "-shm"};

	for (size_t i = 0; i < sizeof(beside) / sizeof(beside[0]); i++) {
		char name[sizeof(h->path) + 16];
		struct stat seen;

		snprintf(name, sizeof(name), "%s%s", h->path, beside[i]);
		if (stat(name, &seen) == 0 && !S_ISREG(seen.st_mode))
			return -EBADMSG;
	}
	return 0;
}

/* frozen: no recorder writes the file, and there is no log of commits beside it. */
static int try_open(struct ows_history *h, bool frozen)
{
	char uri[URI] = "file:"; /* and zeros */
	int64_t application = 0;
	size_t at = strlen(uri);
	int err;

	for (const char *from = h->path; *from && at + 32 < sizeof(uri); from++) {
		if (strchr("%?#", *from))
			at += (size_t)snprintf(uri + at, sizeof(uri) - at, "%%%02X", *from);
		else
			uri[at++] = *from;
	}
	snprintf(uri + at, sizeof(uri) - at, "%s", frozen ? "?immutable=1" : "");
	err = sqlite3_open_v2(uri, &h->db,
	                      SQLITE_OPEN_READONLY | SQLITE_OPEN_NOMUTEX | SQLITE_OPEN_URI, NULL);
	err = sql_errno(h->db, err);
	if (!err) {
		open_armed(h);
		err = sql_ask(h->db, "pragma user_version", &h->version);
	}
	if (err >= 0)
		err = sql_ask(h->db, "pragma application_id", &application);
	if (err >= 0)
		err = application != HISTORY_APPLICATION ? -EBADMSG
		      : h->version < HISTORY_SCHEMA_READ || h->version > HISTORY_SCHEMA
		              ? -EPROTONOSUPPORT
		              : tables_check(h->db);
	for (int i = 0; !err && i < H_COUNT; i++)
		err = sql_errno(h->db,
		                sqlite3_prepare_v3(h->db, texts[i], -1, SQLITE_PREPARE_PERSISTENT,
		                                   &h->statements[i], NULL));
	return err;
}

static void close_file(struct ows_history *h)
{
	for (int i = 0; i < H_COUNT; i++) {
		sqlite3_finalize(h->statements[i]);
		h->statements[i] = NULL;
	}
	sqlite3_close(h->db);
	h->db = NULL;
}

/* A reader that cannot write beside the file needs what the recorder leaves there, or no log. */
static int open_file(struct ows_history *h)
{
	char log[sizeof(h->path) + 8];
	struct stat seen;
	int err;

	if (access(h->path, R_OK) < 0 || stat(h->path, &seen) < 0)
		return -errno;
	h->device = seen.st_dev;
	h->inode = seen.st_ino;
	h->size = seen.st_size;
	open_allow(h);
	err = check_files(h);
	if (err)
		return err;
	err = try_open(h, false);
	snprintf(log, sizeof(log), "%s-wal", h->path);
	if (err && err != -EPROTONOSUPPORT && err != -ENOMEM && err != -ETIMEDOUT &&
	    (stat(log, &seen) < 0 || seen.st_size == 0)) {
		close_file(h);
		err = try_open(h, true);
	}
	if (err)
		close_file(h);
	return err;
}

/* --- What it has ----------------------------------------------------------------------------- */

static void open_forget(struct ows_history *h)
{
	for (int i = h->read.given; i < h->read.count; i++)
		free(h->read.ready[i].text);
	free(h->read.text);
	memset(&h->read, 0, sizeof(h->read));
	memset(&h->list, 0, sizeof(h->list));
	for (int i = 0; i < h->signal_count; i++) {
		free(h->signals[i].name);
		free(h->signals[i].unit);
		free(h->signals[i].identity);
		free(h->signals[i].former);
	}
	free(h->signals);
	free(h->sessions);
	h->signals = NULL;
	h->sessions = NULL;
	h->signal_count = h->session_count = 0;
}

/* Each row into a list that grows; *count are in it after an error too. */
static int read_rows(struct ows_history *h, const char *text, void **list, int *count, size_t size,
                     int (*take)(sqlite3_stmt *from, void *to))
{
	sqlite3_stmt *from;
	int room = 0, got;
	int err = sql_errno(h->db, sqlite3_prepare_v2(h->db, text, -1, &from, NULL));

	if (err)
		return err;
	while ((got = sql_next(from)) == 1) {
		if (*count == ROWS_MOST) {
			got = -EBADMSG;
			break;
		}
		if (*count == room) {
			void *more = reallocarray(*list, (size_t)(room += room + 16), size);

			if (!more) {
				got = -ENOMEM;
				break;
			}
			*list = more;
		}
		memset((char *)*list + (size_t)*count * size, 0, size);
		got = take(from, (char *)*list + (size_t)(*count)++ * size);
		if (got < 0)
			break;
	}
	sqlite3_finalize(from);
	return got;
}

static int take_session(sqlite3_stmt *from, void *to)
{
	*(struct session *)to = (struct session){
		.start = handle_within(sqlite3_column_int64(from, 0), 0, MOST_ID),
		.boot = sqlite3_column_int64(from, 1),
		.base = handle_within(sqlite3_column_int64(from, 2), -MOST_ID, MOST_ID),
		.date = handle_within(sqlite3_column_int64(from, 3), -MOST_ID, MOST_ID),
		.trusted = sqlite3_column_int(from, 4) != 0,
		.reason = (uint8_t)sqlite3_column_int(from, 5),
	};
	return 0;
}

static int take_signal(sqlite3_stmt *from, void *to)
{
	struct known_signal *signal = to;
	char **const texts_of[] = {&signal->name, &signal->unit, &signal->identity,
	                           &signal->former};
	bool all = true;

	signal->number = (uint32_t)sqlite3_column_int64(from, 0);
	for (int i = 0; i < 4; i++) {
		const char *text = (const char *)sqlite3_column_text(from, 1 + i);

		*texts_of[i] = strdup(text ? text : "");
		all = all && *texts_of[i];
	}
	signal->type = (uint8_t)sqlite3_column_int(from, 5);
	signal->output = (uint8_t)sqlite3_column_int(from, 6);
	signal->decimals = (int8_t)sqlite3_column_int(from, 7);
	return all ? 0 : -ENOMEM;
}

static int read_places(struct ows_history *h)
{
	int64_t raw_end = 0, gap = 0, event = 0, seen = 0, minute = -1;
	/* what is written of the last run says how long it looked */
	struct {
		const char *text;
		int64_t *to;
	} asked[] = {
		{"select max(id) from raw", &raw_end},
		{"select min(id) from raw", &h->raw_first},
		{"select max(start) from gap where signal = 0", &gap},
		{"select max(id) from event", &event},
		{"select max(seen) from session", &seen},
		{"select (min(id) >> 16) * 60000000 from minute", &minute},
		{"select ((max(id) >> 16) + 1) / 60 * 3600000000 from minute", &h->minute_end},
	};

	h->hour_end = h->minute_end = 0;
	h->raw_first = INT64_MAX;
	for (size_t i = 0; i < sizeof(asked) / sizeof(asked[0]); i++) {
		int err = sql_ask(h->db, asked[i].text, asked[i].to);

		if (err < 0)
			return err;
		/* without a row it is behind all of them */
		if (asked[i].to != &h->raw_first || *asked[i].to != INT64_MAX)
			*asked[i].to = handle_within(*asked[i].to, -1, MOST_ID);
	}
	/* each hour is written with its last minute; to ask the hours reads eight of each signal */
	h->hour_end = h->minute_end / HOUR_US * HOUR_US;
	if (minute < 0) {
		int err = sql_ask(h->db, SCHEMA_HOURS_END, &h->hour_end);

		if (err < 0)
			return err;
		h->hour_end = handle_within(h->hour_end, 0, MOST_ID);
		minute = h->minute_end = h->hour_end;
	}
	h->minute_first = minute;
	h->end = raw_end > gap ? raw_end : gap;
	h->end = event > h->end ? event : h->end;
	h->end = seen > h->end ? seen : h->end;
	return 0;
}

/* All at one moment of the file. */
static int open_look(struct ows_history *h)
{
	int err = sql_exec(h->db, "begin");

	if (err)
		return err;
	/* the recorder may have brought its tables up to date */
	err = sql_ask(h->db, "pragma user_version", &h->version);
	if (err >= 0)
		err = read_places(h);
	if (!err)
		err = read_rows(
			h,
			"select start, boot, base, date, trusted, (select max(reason) from gap where"
			" gap.until = session.start and signal = 0) from session order by start",
			(void **)&h->sessions, &h->session_count, sizeof(*h->sessions),
			take_session);
	if (!err)
		err = read_rows(
			h,
			h->version < HISTORY_SCHEMA_IDENTITY
				? "select signal, name, unit, null, null, type, output, decimals"
				  " from signal"
				: "select signal, name, unit, identity, former, type, output,"
				  " decimals from signal",
			(void **)&h->signals, &h->signal_count, sizeof(*h->signals), take_signal);
	sqlite3_exec(h->db, "commit", NULL, NULL, NULL);
	if (err < 0) {
		open_forget(h);
		return err;
	}
	for (int i = 0; i < h->session_count; i++)
		h->sessions[i].end = i + 1 < h->session_count ? h->sessions[i + 1].start
		                                              : h->end + 1;
	return 0;
}

int ows_history_open(const char *instance, const char *directory, struct ows_history **handle)
{
	char place[HISTORY_PATH];
	struct ows_history *h;
	int err = directory ? 0 : ows_history_place(instance, place, sizeof(place));

	*handle = NULL;
	if (err)
		return err;
	h = calloc(1, sizeof(*h));
	if (!h)
		return -ENOMEM;
	h->boot = history_boot_present();
	if (snprintf(h->path, sizeof(h->path), "%s/%s", directory ? directory : place,
	             HISTORY_FILE) >= (int)sizeof(h->path))
		err = -ENAMETOOLONG;
	if (!err)
		err = open_file(h);
	if (!err)
		err = open_look(h);
	if (err) {
		ows_history_close(h);
		return err;
	}
	*handle = h;
	return 0;
}

void ows_history_close(struct ows_history *h)
{
	if (!h)
		return;
	open_forget(h);
	close_file(h);
	free(h);
}

int ows_history_refresh(struct ows_history *h)
{
	struct stat seen;
	int err = 0;

	open_forget(h);
	/* another one may be there now: the one before was damaged, or deleted */
	if (!h->db || stat(h->path, &seen) < 0 || seen.st_dev != h->device ||
	    seen.st_ino != h->inode) {
		close_file(h);
		err = open_file(h);
	} else {
		h->size = seen.st_size;
		open_allow(h);
	}
	return err ? err : open_look(h);
}

int ows_history_span(struct ows_history *h, int64_t *from_ns, int64_t *until_ns)
{
	if (!h->session_count)
		return -ENODATA;
	*until_ns = handle_wall_us(&h->sessions[h->session_count - 1], h->end) * NS_PER_US;
	*from_ns = *until_ns;
	for (int i = 0; i < h->session_count; i++) {
		const struct session *session = &h->sessions[i];
		int64_t from = handle_wall_us(session, session->start) * NS_PER_US;

		*from_ns = from < *from_ns ? from : *from_ns;
	}
	return 0;
}

bool handle_range(const struct session *session, int64_t from_us, int64_t until_us, int64_t *first,
                  int64_t *end)
{
	int64_t from = session->start + session->date, until = session->end + session->date;

	from = from_us > from ? from_us : from;
	until = until_us < until ? until_us : until;
	*first = from - session->date;
	*end = until - session->date;
	return from < until;
}
