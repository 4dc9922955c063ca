/* SPDX-License-Identifier: MIT */
/* The files of the page: those of a directory whose names and types are those of a page. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

/* A descriptor of the directory, if it has an index.html; else a negative errno. */
int files_open(const char *directory);
struct file {
	uint64_t size;
	const char *type;
	bool gzip;    /* the bytes are those of gzip */
	char tag[48]; /* changes with the contents, and with the encoding */
};

/*
 * Open the file of a path ("" is index.html). Returns a descriptor, or -ENOENT or another negative
 * errno. gzip: the browser takes a file NAME.gz in place of NAME, if that stands beside it and is
 * no older. A directory of -1 has none.
 */
int files_find(int directory, const char *path, bool gzip, struct file *file);
/* Does a header Accept-Encoding name gzip? NULL: there is no such header. Pure. */
bool files_takes_gzip(const char *accepts);
