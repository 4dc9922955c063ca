/* SPDX-License-Identifier: MIT */
/* UTF-8, and which of its characters make a line read other than it is. */
#ifndef SIGNAL_UTF8_H
#define SIGNAL_UTF8_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/*
 * The next character: its code point, or -1 for a byte that begins no whole character (of the
 * shortest form, no surrogate). *text and *len move behind it. len > 0.
 */
int32_t utf8_next(const char **text, size_t *len);

/* A control character, a line separator, or what turns the direction of writing; -1 too. */
bool utf8_disturbs(int32_t code);

#endif
