/* SPDX-License-Identifier: MIT */
/* The text that owdump and busdump share: one line a property, bytes that are no text as \xNN. */
#pragma once

#include <stddef.h>
#include <stdint.h>

/* One read answered: ret >= 0 prints data (len bytes), else ret. */
void lines_answer(const char *path, int ret, const void *data, size_t len);
/* One write answered. */
void lines_written(const char *path, int ret);

/* Each path on standard input; # begins a comment line. */
void lines_of_paths(void (*read)(const char *path));
/* Each "PATH VALUE" on standard input. */
void lines_of_values(void (*write)(const char *path, const uint8_t *value, size_t len));
