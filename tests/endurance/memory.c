/* SPDX-License-Identifier: MIT */
/* Counts the allocations of the watched thread, and the blocks and descriptors that live. */
#include <fcntl.h>
#include <stddef.h>

#include "tests/endurance/memory.h"

#define DESCRIPTORS 1024

void *__real_malloc(size_t size);
void *__real_calloc(size_t n, size_t size);
void *__real_realloc(void *old, size_t size);
void *__real_aligned_alloc(size_t align, size_t size);
char *__real_strdup(const char *text);
void __real_free(void *block);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t n, size_t size);
void *__wrap_realloc(void *old, size_t size);
void *__wrap_aligned_alloc(size_t align, size_t size);
char *__wrap_strdup(const char *text);
void __wrap_free(void *block);

static bool watching;
static unsigned long watched;
static long blocks;

void memory_watch(bool yes)
{
	watching = yes;
}

unsigned long memory_watched(void)
{
	return watched;
}

long memory_blocks(void)
{
	return blocks;
}

static void *count(void *block)
{
	watched += watching;
	blocks += block != NULL;
	return block;
}

void *__wrap_malloc(size_t size)
{
	return count(__real_malloc(size));
}

void *__wrap_calloc(size_t n, size_t size)
{
	return count(__real_calloc(n, size));
}

void *__wrap_realloc(void *old, size_t size)
{
	void *block = __real_realloc(old, size);

	watched += watching;
	blocks += !old && block;
	return block;
}

void *__wrap_aligned_alloc(size_t align, size_t size)
{
	return count(__real_aligned_alloc(align, size));
}

char *__wrap_strdup(const char *text)
{
	return count(__real_strdup(text));
}

void __wrap_free(void *block)
{
	blocks -= block != NULL;
	__real_free(block);
}

unsigned memory_descriptors(void)
{
	unsigned n = 0;

	for (int fd = 0; fd < DESCRIPTORS; fd++)
		n += fcntl(fd, F_GETFD) >= 0;
	return n;
}
