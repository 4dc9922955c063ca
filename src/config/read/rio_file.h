/* SPDX-License-Identifier: MIT */
/* A .rio file read into memory. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct config_report;

/*
 * Read a whole regular file into *text (malloc, with NUL at the end, which *len does not count).
 * Errors are reported through report: a negative errno; -EFBIG as above, -EILSEQ: the file is
 * UTF-16, -EINVAL: the file is not regular, and was not opened. Blocking.
 */
int rio_read(const char *file, struct config_report *report, char **text, size_t *len);

/* Is it a link that leads to no file? What to say then. */
#define RIO_DANGLES "is a symbolic link to a file that is not there"
bool rio_dangles(const char *file);
