/* SPDX-License-Identifier: MIT */
/* The files of the page: those of a directory whose names and types are those of a page. */
#pragma once

#include <stdint.h>

#define FILES_TAG 48

/* A descriptor of the directory, if it has an index.html; else a negative errno. */
int files_open(const char *directory);
/*
 * Open the file of a path ("" is index.html). Returns a descriptor, or -ENOENT or another negative
 * errno; with its size, its type and a tag that changes with its contents. A directory of -1 has
 * none.
 */
int files_find(int directory, const char *path, uint64_t *size, const char **type,
               char tag[FILES_TAG]);
