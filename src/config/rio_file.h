/* SPDX-License-Identifier: MIT */
/* A .rio file read into memory. */
#ifndef CONFIG_RIO_FILE_H
#define CONFIG_RIO_FILE_H

#include <stddef.h>

struct config_report;

/*
 * Read a whole regular file into *text (malloc, NUL behind *len bytes). Errors are reported through
 * report: negative errno; -EFBIG as above, -EILSEQ it is UTF-16, -EINVAL it is no regular file, and
 * was not opened. Blocking.
 */
int rio_read(const char *file, struct config_report *report, char **text, size_t *len);

#endif
