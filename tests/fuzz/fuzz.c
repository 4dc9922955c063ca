/* SPDX-License-Identifier: MIT */
/* The entry of a fuzz target, the bytes of its case, and the functions that it must not call. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/types.h>

#include "tests/fuzz/fuzz.h"

#ifndef __has_feature
#define __has_feature(x) 0
#endif
#if defined(__SANITIZE_ADDRESS__) || __has_feature(address_sanitizer)
/* Both compilers' sanitizers have these, not both have their header. */
int __sanitizer_install_malloc_and_free_hooks(void (*taken)(const volatile void *, size_t),
                                              void (*given_back)(const volatile void *));
size_t __sanitizer_get_allocated_size(const volatile void *p);
void __asan_poison_memory_region(const volatile void *p, size_t n);
void __asan_unpoison_memory_region(const volatile void *p, size_t n);
#define WATCHED 1
#else
#define WATCHED 0
#endif

void setUp(void)
{
}

void tearDown(void)
{
}

#if WATCHED
static bool counting;
static size_t held, peak;

static void taken(const volatile void *p, size_t size)
{
	(void)p;
	if (!counting)
		return;
	held += size;
	if (held > peak)
		peak = held;
}

static void given_back(const volatile void *p)
{
	size_t size;

	if (!counting || !p)
		return;
	size = __sanitizer_get_allocated_size(p);
	held -= size < held ? size : held;
}

static void begin(void)
{
	static bool installed;

	if (!installed)
		__sanitizer_install_malloc_and_free_hooks(taken, given_back);
	installed = true;
	held = peak = 0;
	counting = true;
}

static void end(size_t n)
{
	char text[96];

	counting = false;
	if (peak <= fuzz_memory(n))
		return;
	snprintf(text, sizeof(text), "%zu bytes of memory for an input of %zu", peak, n);
	TEST_FAIL_MESSAGE(text);
}

void fuzz_forbid(const void *bytes, size_t n, bool yes)
{
	if (yes)
		__asan_poison_memory_region(bytes, n);
	else
		__asan_unpoison_memory_region(bytes, n);
}
#else
void fuzz_forbid(const void *bytes, size_t n, bool yes)
{
	(void)bytes, (void)n, (void)yes;
}

static void begin(void)
{
}

static void end(size_t n)
{
	(void)fuzz_memory(n);
}
#endif

/* In the place of getpid(): an input does the same in every process. */
pid_t __wrap_getpid(void);
pid_t __wrap_getpid(void)
{
	return 4711;
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n)
{
	Unity.TestFile = "";
	Unity.CurrentTestName = "fuzz_one";
	Unity.CurrentTestFailed = 0;
	if (TEST_PROTECT()) {
		begin();
		fuzz_one(bytes, n);
		end(n);
	}
	if (Unity.CurrentTestFailed) {
		putchar('\n');
		fflush(stdout);
		abort();
	}
	return 0;
}

uint8_t fuzz_byte(struct fuzz *fuzz)
{
	return fuzz->at < fuzz->end ? *fuzz->at++ : 0;
}

uint32_t fuzz_word(struct fuzz *fuzz)
{
	uint32_t word = 0;

	for (int i = 0; i < 4; i++)
		word |= (uint32_t)fuzz_byte(fuzz) << 8 * i;
	return word;
}

int64_t fuzz_long(struct fuzz *fuzz)
{
	uint64_t low = fuzz_word(fuzz);

	return (int64_t)((uint64_t)fuzz_word(fuzz) << 32 | low);
}

const uint8_t *fuzz_bytes(struct fuzz *fuzz, size_t most, size_t *n)
{
	const uint8_t *bytes;

	*n = fuzz_byte(fuzz);
	if (*n > most)
		*n = most;
	if (*n > fuzz_left(fuzz))
		*n = fuzz_left(fuzz);
	bytes = fuzz->at;
	fuzz->at += *n;
	return bytes;
}

const char *fuzz_line(struct fuzz *fuzz, char *room, size_t size)
{
	size_t n = 0;

	while (fuzz->at < fuzz->end && *fuzz->at && *fuzz->at != '\n') {
		if (n + 1 < size)
			room[n++] = (char)*fuzz->at;
		fuzz->at++;
	}
	fuzz->at += fuzz->at < fuzz->end;
	room[n] = '\0';
	return room;
}
