/* SPDX-License-Identifier: MIT */
/* The files of the page: those that a directory had at the start, and no others. */
#pragma once

#include <stdint.h>

#define FILES 128
#define FILES_NAME 64
#define FILES_TAG 48

struct files {
	int directory; /* -1: there is none */
	unsigned count;
	char names[FILES][FILES_NAME]; /* "style.css", "uplot/uPlot.css" */
};

/* Take the names of the files there, and one level of directories deeper. 0 or a negative errno. */
int files_open(struct files *files, const char *directory);
void files_close(struct files *files);
/*
 * Open the file of a path ("" is index.html). Returns a descriptor, or -ENOENT or another negative
 * errno; with its size, its type and a tag that changes with its contents.
 */
int files_find(const struct files *files, const char *path, uint64_t *size, const char **type,
               char tag[FILES_TAG]);
