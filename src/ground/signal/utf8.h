/* SPDX-License-Identifier: MIT */
/* UTF-8, and which of its characters make a line of text look other than it is. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/*
 * The next character: its code point, or -1 for a byte that begins no whole character (of the
 * shortest form, no surrogate). *text and *len move past the character. len > 0.
 */
int32_t utf8_next(const char **text, size_t *len);

/*
 * Is code a control character, a line separator, a character that turns the direction of writing,
 * or -1?
 */
bool utf8_disturbs(int32_t code);
