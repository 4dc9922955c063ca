/* SPDX-License-Identifier: MIT */
#ifndef WRITER_CHECK_H
#define WRITER_CHECK_H

#include <stddef.h>

struct answer;

/*
 * Check a text as owsd --check does, as if it stood in file: tables and simulations that it names
 * are read. Problems go to the answer. 0 or a negative errno. Blocking.
 */
int check_text(const char *file, const char *text, size_t len, struct answer *answer);

#endif
