/* SPDX-License-Identifier: MIT */
/*
 * A handle of libows-history: the file, its runs of the recorder and its signals, and what is being
 * read.
 *
 * Room src/libhistory: the library that reads history, for consumers. Uses src/shm, src/signal,
 * src/history.
 */
#pragma once

#include <sqlite3.h>
#include <stdbool.h>
#include <sys/types.h>

#include "src/history/place.h"
#include "src/libhistory/ows_history.h"

#define NS_PER_US 1000
#define READY 256

enum handle_statement { H_RAW, H_GAPS, H_STEPS, H_ALL, H_MINUTE, H_HOUR, H_EVENTS, H_COUNT };

/* A run of the recorder: ids from start up to end. */
struct session {
	int64_t start, end, base, date, boot;
	bool trusted;
	uint8_t reason; /* of the gap before it */
};
struct known_signal {
	char *name, *unit;
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

struct ows_history {
	char path[HISTORY_PATH + 64];
	sqlite3 *db;
	sqlite3_stmt *statements[H_COUNT];
	dev_t device;
	ino_t inode;
	int64_t boot; /* that this machine is in */
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
