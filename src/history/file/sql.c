/* SPDX-License-Identifier: MIT */
/* SQLite's results as errno, and the binding of parameters. */
#include "src/history/file/sql.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

int sql_errno(sqlite3 *db, int rc)
{
	int err = db ? sqlite3_system_errno(db) : 0;

	switch (rc & 0xff) {
	case SQLITE_OK:
	case SQLITE_ROW:
	case SQLITE_DONE:
		return 0;
	case SQLITE_BUSY:
	case SQLITE_LOCKED:
		return -EAGAIN;
	case SQLITE_CORRUPT:
	case SQLITE_NOTADB:
		return -EBADMSG;
	case SQLITE_INTERRUPT:
		return -ETIMEDOUT;
	case SQLITE_FULL:
		return -ENOSPC;
	case SQLITE_READONLY:
		return -EROFS;
	case SQLITE_NOMEM:
		return -ENOMEM;
	case SQLITE_PERM:
	case SQLITE_AUTH:
		return -EACCES;
	case SQLITE_CANTOPEN:
		return err ? -err : -ENOENT;
	default:
		return err ? -err : -EIO;
	}
}

int sql_exec(sqlite3 *db, const char *text)
{
	return sql_errno(db, sqlite3_exec(db, text, NULL, NULL, NULL));
}

static void bind_all(sqlite3_stmt *statement, const char *types, va_list args)
{
	sqlite3_reset(statement);
	for (int i = 0; types[i]; i++) {
		const char *text;
		double number;

		switch (types[i]) {
		case 'i':
			sqlite3_bind_int64(statement, i + 1, va_arg(args, int64_t));
			break;
		case 'd':
			number = va_arg(args, double);
			if (isnan(number))
				sqlite3_bind_null(statement, i + 1);
			else
				sqlite3_bind_double(statement, i + 1, number);
			break;
		case 't':
			text = va_arg(args, const char *);
			sqlite3_bind_text(statement, i + 1, text, -1, SQLITE_STATIC);
			break;
		default:
			sqlite3_bind_null(statement, i + 1);
		}
	}
}

void sql_bind(sqlite3_stmt *statement, const char *types, ...)
{
	va_list args;

	va_start(args, types);
	bind_all(statement, types, args);
	va_end(args);
}

int sql_next(sqlite3_stmt *statement)
{
	int rc = sqlite3_step(statement), err;

	if (rc == SQLITE_ROW)
		return 1;
	err = sql_errno(sqlite3_db_handle(statement), rc);
	sqlite3_reset(statement);
	return err;
}

int sql_run(sqlite3_stmt *statement, const char *types, ...)
{
	va_list args;

	va_start(args, types);
	bind_all(statement, types, args);
	va_end(args);
	return sql_next(statement);
}

int sql_number(sqlite3_stmt *statement, int64_t *value, const char *types, ...)
{
	va_list args;
	int got;

	va_start(args, types);
	bind_all(statement, types, args);
	va_end(args);
	got = sql_next(statement);
	if (got == 1 && sqlite3_column_type(statement, 0) != SQLITE_NULL)
		*value = sqlite3_column_int64(statement, 0);
	sqlite3_reset(statement);
	return got;
}

int sql_ask(sqlite3 *db, const char *text, int64_t *value)
{
	sqlite3_stmt *statement;
	int err = sql_errno(db, sqlite3_prepare_v2(db, text, -1, &statement, NULL));

	if (err)
		return err;
	err = sql_number(statement, value, "");
	sqlite3_finalize(statement);
	return err;
}

/* --- Tables ---------------------------------------------------------------------------------- */

int tables_check(sqlite3 *db)
{
	/* a virtual table has no page, and a column that is computed is one "as" something */
	static const char text[] =
		"select count(*) from sqlite_master where type = 'table' and rootpage > 0 and name in"
		" ('session', 'signal', 'raw', 'gap', 'event', 'minute', 'hour')"
		" and lower(sql) not glob '*[^a-z]as[^a-z]*'";
	int64_t count = 0;
	int err = sql_ask(db, text, &count);

	return err < 0 ? err : count == 7 ? 0 : -EBADMSG;
}
