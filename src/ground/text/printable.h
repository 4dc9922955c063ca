/* SPDX-License-Identifier: MIT */
#pragma once

#include <stdarg.h>
#include <stddef.h>

/*
 * Make text fit for a terminal, in place: each control character becomes '?', and so does each byte
 * that is not UTF-8 (a terminal of eight bits takes 9Bh for a command) and each character that
 * would make a line read other than it is (U+2028 to U+202E, U+2066 to U+2069). Returns the new
 * length; does not terminate the text.
 */
size_t printable(char *text, size_t len);

/* Make text fit to stand in quotes, in place: its own become '. */
void printable_quoted(char *text);

/* The length of text, at most that many bytes, without a UTF-8 character that is cut there. */
size_t printable_cut(const char *text, size_t most);

/*
 * A message as vprintf() would print it, made printable. A message longer than PRINTABLE_LINE bytes
 * (a long word of the user stands in it) loses its middle, because its end has the reason. The
 * caller frees it; NULL: no memory.
 */
#define PRINTABLE_LINE 1000
char *printable_line(const char *format, va_list args) __attribute__((format(printf, 1, 0)));
