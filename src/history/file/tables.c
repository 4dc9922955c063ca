/* SPDX-License-Identifier: MIT */
/* Whether the tables of a file are tables. */
#include "src/history/file/tables.h"

#include <errno.h>
#include <stdint.h>

#include "src/history/file/sql.h"

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
