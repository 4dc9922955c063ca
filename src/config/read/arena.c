/* SPDX-License-Identifier: MIT */
/* An arena: memory that is taken piece by piece and freed all at once. */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "src/config/read/arena.h"

#define CHUNK_ROOM (16 * 1024)

struct arena_chunk {
	struct arena_chunk *next;
	size_t room, used;
	_Alignas(max_align_t) unsigned char data[];
};

static struct arena_chunk *chunk_make(size_t room)
{
	struct arena_chunk *chunk = NULL;

	if (room <= SIZE_MAX - sizeof(*chunk))
		chunk = calloc(1, sizeof(*chunk) + room);
	if (chunk)
		chunk->room = room;
	return chunk;
}

void *arena_take(struct arena *arena, size_t size)
{
	const size_t align = _Alignof(max_align_t);
	struct arena_chunk *chunk = arena->chunks;

	if (size > SIZE_MAX - align)
		return NULL;
	size = (size + align - 1) / align * align;
	if (!chunk || chunk->room - chunk->used < size) {
		chunk = chunk_make(size > CHUNK_ROOM ? size : CHUNK_ROOM);
		if (!chunk)
			return NULL;
		chunk->next = arena->chunks;
		arena->chunks = chunk;
	}
	chunk->used += size;
	return chunk->data + chunk->used - size;
}

char *arena_text(struct arena *arena, const char *text, size_t len)
{
	char *copy = len < SIZE_MAX ? arena_take(arena, len + 1) : NULL;

	if (copy && len)
		memcpy(copy, text, len);
	return copy;
}

void arena_free(struct arena *arena)
{
	while (arena->chunks) {
		struct arena_chunk *next = arena->chunks->next;

		free(arena->chunks);
		arena->chunks = next;
	}
}
