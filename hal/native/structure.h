/* SPDX-License-Identifier: MIT */
/* /structure: what properties a family has. */
#pragma once

#include <stddef.h>

struct family;

/* Reading a path in /structure. The text's length or an error. */
int structure_read(const char *path, size_t len, char *text, size_t room);
/* The family that the path begins with, in *used bytes; NULL: none. */
const struct family *structure_family(const char *path, size_t len, size_t *used);
