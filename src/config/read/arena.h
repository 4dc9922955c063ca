/* SPDX-License-Identifier: MIT */
/* An arena: memory that is taken piece by piece and freed all at once. */
#pragma once

#include <stddef.h>

struct arena_chunk;
struct arena { /* all zero: empty */
	struct arena_chunk *chunks;
};

/* Take size zeroed bytes, aligned for any type. NULL: no memory. */
void *arena_take(struct arena *arena, size_t size);
/* Take a copy of len bytes of text, with a NUL. */
char *arena_text(struct arena *arena, const char *text, size_t len);
void arena_free(struct arena *arena);
