/* SPDX-License-Identifier: MIT */
#ifndef TESTS_FUZZ_JSON_VALID_H
#define TESTS_FUZZ_JSON_VALID_H

#include <stdbool.h>
#include <stddef.h>

/* Is it one JSON value of RFC 8259, in UTF-8 and nothing behind it? */
bool json_valid(const char *text, size_t n);

#endif
