/* SPDX-License-Identifier: MIT */
#pragma once

#include <stdbool.h>
#include <stddef.h>

/* Is it one JSON value of RFC 8259, in UTF-8 and nothing behind it? */
bool json_valid(const char *text, size_t n);
