/* SPDX-License-Identifier: MIT */
/* What the writer of history says to SQLite, prepared once for a file. */
#pragma once

#include <sqlite3.h>

enum statement {
	S_BEGIN,
	S_COMMIT,
	S_ROLLBACK,
	S_FIND,
	S_TAKE,
	S_NAME,
	S_RENEW,
	S_VALUE,
	S_GAP,
	S_LONGER,
	S_END_GAP,
	S_EVENT,
	S_MINUTE,
	S_MINUTES,
	S_HOUR,
	S_SESSION,
	S_DATE,
	S_SEEN,
	S_LAST,
	S_OURS,
	S_BEFORE,
	S_SINCE,
	S_REPLAY,
	S_KNOWN,
	S_COUNT
};

/* Prepare them all. 0 or a negative errno: then statements_close() frees those that are. */
int statements_open(sqlite3 *db, sqlite3_stmt *statements[S_COUNT]);
/* Free them; they are NULL then. */
void statements_close(sqlite3_stmt *statements[S_COUNT]);
