/* SPDX-License-Identifier: MIT */
/*
 * The file in its directory, open for the writer. The directory is locked while it is: a second
 * writer gets -EBUSY. A damaged file is put aside, under a name that is said. Blocking.
 */
#pragma once

#include <sqlite3.h>
#include <stdbool.h>
#include <stdint.h>

struct history_file {
	const char *directory; /* made if it is missing; its parent has to be there */
	void (*say)(void *ctx, const char *text);
	void *ctx;
	sqlite3 *db; /* NULL: not open */
	int lock;    /* its descriptor; -1 */
	uint64_t device, inode;
};

/* 0 or a negative errno: see schema_open(). */
int file_open(struct history_file *file);
void file_close(struct history_file *file);
/* Was it deleted, replaced or unmounted? What is written into it then is lost. */
bool file_is_there(const struct history_file *file);
/* Close it, and give it another name. */
int file_put_aside(struct history_file *file);
