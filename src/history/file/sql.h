/* SPDX-License-Identifier: MIT */
/* What writer and readers of the file need of SQLite: errors as errno, and statements in a line. */
#pragma once

#include <sqlite3.h>
#include <stdbool.h>
#include <stdint.h>

/*
 * What a result means, as a negative errno; 0: none of the errors. -EBADMSG: the file is damaged or
 * no database; -EAGAIN: another program has it locked.
 */
int sql_errno(sqlite3 *db, int rc);
/* Statements without result. */
int sql_exec(sqlite3 *db, const char *text);
/*
 * Reset the statement and bind its parameters, a letter for each: i int64_t, d double (NaN is
 * null), t const char * (static until the statement is reset; NULL is null), n null.
 */
void sql_bind(sqlite3_stmt *statement, const char *types, ...);
/* The next row: 1; 0: none, and the statement is reset; or a negative errno, likewise. */
int sql_next(sqlite3_stmt *statement);
/* Bind, and the first row. */
int sql_run(sqlite3_stmt *statement, const char *types, ...);
/* The same, and its first column; *value stays if that is null. The statement is reset. */
int sql_number(sqlite3_stmt *statement, int64_t *value, const char *types, ...);
/* The same of a text; prepared for this once. */
int sql_ask(sqlite3 *db, const char *text, int64_t *value);

/*
 * Are the tables of the file tables, which hold what is read? A view, or a column that is computed,
 * in its place could take for ever. 0; -EBADMSG: something else.
 */
int tables_check(sqlite3 *db);
