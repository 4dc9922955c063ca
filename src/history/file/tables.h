/* SPDX-License-Identifier: MIT */
/* A view, or a column that is computed, in the place of what is read could take for ever. */
#pragma once

#include <sqlite3.h>

/* Are the tables of the file tables, which hold what is read? 0; -EBADMSG: something else. */
int tables_check(sqlite3 *db);
