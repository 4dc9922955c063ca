/* SPDX-License-Identifier: MIT */
/*
 * A handle of libows-history: the file, its runs of the recorder and its signals, and what is being
 * read.
 *
 * Room src/history/library: the library that reads history, for consumers.
 */
#pragma once

#include <sqlite3.h>
#include <stdbool.h>
#include <sys/types.h>

#include "src/history/file/place.h"
#include "src/public/ows_history.h"

#define NS_PER_US 1000
/* Whatever the file says: ids and what is added to them are within the first, dates the second */
#define MOST_ID (INT64_MAX / NS_PER_US)
#define MOST_US (INT64_C(4600000000) * 1000000) /* 2115 */
#define READY 256

enum handle_statement {
	H_RAW,
	H_GAPS,
	H_STEPS,
	H_ALL,
	H_MINUTES,
	H_MINUTE,
	H_HOUR,
	H_EVENTS,
	H_COUNT
};

/* A run of the recorder: ids from start up to end. */
struct session {
	int64_t start, end, base, date, boot;
	bool trusted;
	uint8_t reason; /* of the gap before it */
};
struct known_signal {
	char *name, *unit, *identity;
	char *former; /* names that it had: " hall attic " */
	uint32_t number;
	uint8_t type, output;
	int8_t decimals;
};

/* A row of raw, or a gap. */
struct step {
	int64_t id;
	double number;
	int64_t integer;
	char *text; /* of a string, owned */
	uint8_t type, quality, reason;
	bool known;
};

/* A number that the file has of a time, as one that can be reckoned with. */
static inline int64_t handle_within(int64_t number, int64_t least, int64_t most)
{
	return number < least ? least : number > most ? most : number;
}

/* Microseconds since 1970, and boot time, of an id. */
static inline int64_t handle_wall_us(const struct session *session, int64_t id)
{
	return handle_within(id + session->date, 0, MOST_US);
}
static inline int64_t handle_boot_us(const struct session *session, int64_t id)
{
	return handle_within(id - session->base, -MOST_US, MOST_US);
}

struct ows_history {
	char path[HISTORY_PATH + 64];
	sqlite3 *db;
	sqlite3_stmt *statements[H_COUNT];
	dev_t device;
	ino_t inode;
	int64_t size;     /* in bytes, when it was opened or refreshed */
	int64_t boot;     /* that this machine is in */
	int64_t version;  /* of the file's tables */
	int64_t until_ns; /* of the thread's processor time: then a call gives up */
	struct session *sessions;
	int session_count;
	int64_t end; /* the id up to which something is known */
	struct known_signal *signals;
	int signal_count;
	/* What has roll-ups: ids; first == end: nothing. */
	int64_t hour_end, minute_first, minute_end, raw_first;
	struct {
		bool on, holds, ended;
		int signal, session;
		int64_t from_us, until_us, next; /* wall clock; id */
		struct step ready[READY];
		int count, given;
		char *text; /* of the item that was given last */
	} read;
	struct {
		bool on;
		int session;
		uint32_t kinds;
		int64_t from_us, until_us, next;
		struct ows_history_event ready[64];
		int count, given;
	} list;
};
