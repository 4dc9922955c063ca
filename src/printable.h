/* SPDX-License-Identifier: MIT */
#ifndef PRINTABLE_H
#define PRINTABLE_H

#include <stddef.h>

/*
 * Make text fit for a terminal, in place: each control character becomes '?', and so does each that
 * would make a line read other than it is (U+2028 to U+202E, U+2066 to U+2069). Returns the new
 * length; the text is not terminated anew.
 */
size_t printable(char *text, size_t len);

#endif
