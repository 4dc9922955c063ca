/* SPDX-License-Identifier: MIT */
/* A tag: a number by which a change of a text shows. */
#pragma once

#include <stddef.h>

#define TAG_TEXT 17 /* 16 hexadecimal digits, and NUL */
void tag_print(const char *bytes, size_t len, char text[TAG_TEXT]);
