/* SPDX-License-Identifier: MIT */
/* A file that is read as a whole. */
#pragma once

#include <stddef.h>

/*
 * What is left of a file, which the caller frees, with a NUL behind it. It may be one byte longer
 * than `most`: then there was more. NULL: *err is a negative errno.
 */
char *file_whole(int fd, size_t most, size_t *len, int *err);

/*
 * The text of a file of at most `most` bytes, which the caller frees. NULL: *err is a negative
 * errno, and why says what is wrong with the file, but for -ENOMEM. A file that is not regular, as
 * a pipe without a writer, is refused: it might never open or end.
 */
char *file_text(const char *file, size_t most, int *err, char *why, size_t why_size);
