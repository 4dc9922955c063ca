/* SPDX-License-Identifier: MIT */
/*
 * Records of a history as a table in a file: SQLite or Parquet. python3 writes it, as it has SQLite
 * in its standard library and Parquet in pyarrow: owsctl is linked with neither, and reads the
 * history as for all other forms. It gives each record to python3 through a pipe, as a line of
 * JSON. All block. The columns: time (ns since 1970), signal, value, text, quality. A value that is
 * not good, and a gap, has neither value nor text; quality has the word for it, or the reason. An
 * integer that a double does not have exactly is in text, as digits.
 */
#pragma once

#include <stdbool.h>
#include <stdio.h>
#include <sys/types.h>

#include "src/public/ows_history.h"

struct table_file {
	FILE *to; /* NULL: none */
	pid_t pid;
};

/*
 * Start the program that writes the file. kind: "sqlite" or "parquet". A file of that name is not
 * touched: python3 then ends at once, which table_file_end() tells. 0, or what is wrong, which is
 * printed.
 */
int table_file_begin(struct table_file *table, const char *kind, const char *path);
void table_file_put(struct table_file *table, const char *signal,
                    const struct ows_history_item *item);
/* Whether nothing more can be put, as python3 has ended, which has said why. */
bool table_file_broken(const struct table_file *table);
/*
 * The file gets its name if status, which is how the reading ended, is CTL_DONE; else there is
 * none. Returns status, or CTL_FAILED where python3 failed.
 */
int table_file_end(struct table_file *table, int status);
