/* SPDX-License-Identifier: MIT */
/*
 * Text on a terminal: how many columns its UTF-8 takes, in any locale, and the removal of what must
 * not reach the terminal.
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>

/* The columns of cleaned text. */
unsigned text_columns(const char *text);

/*
 * Copy len bytes as far as they take at most columns columns and room bytes with the NUL: control
 * characters and what is not UTF-8 become '?'. What does not fit ends in '~'. Returns the columns.
 */
unsigned text_clean(const char *text, size_t len, unsigned columns, char *out, size_t room);
