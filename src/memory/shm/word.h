/* SPDX-License-Identifier: MIT */
/*
 * Access to words that two processes share: 32 bit, by the compiler's atomic builtins on plain
 * integers (an _Atomic in a header is no C++), samples word by word.
 */
#pragma once

#include <stddef.h>
#include <stdint.h>
#include <string.h>

#if __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__
#error "the layout is little-endian and so must be the machine"
#endif

#ifndef __has_feature
#define __has_feature(x) 0
#endif
/*
 * The thread sanitizer does not know fences. For it every word is ordered by itself, which is the
 * same protocol with more barriers.
 */
#if defined(__SANITIZE_THREAD__) || __has_feature(thread_sanitizer)
#define WORD_LOAD __ATOMIC_ACQUIRE
#define WORD_STORE __ATOMIC_RELEASE
#define word_fence(how) __atomic_signal_fence(how)
#else
#define WORD_LOAD __ATOMIC_RELAXED
#define WORD_STORE __ATOMIC_RELAXED
#define word_fence(how) __atomic_thread_fence(how)
#endif

/* A function type cannot say may_alias: these two are the only typedefs of data here. */
typedef uint32_t __attribute__((may_alias)) shm_word;
typedef uint64_t __attribute__((may_alias, aligned(8))) shm_double_word;

static inline uint32_t word_get(const uint32_t *word)
{
	return __atomic_load_n(word, __ATOMIC_RELAXED);
}

static inline void word_set(uint32_t *word, uint32_t value)
{
	__atomic_store_n(word, value, __ATOMIC_RELAXED);
}

/* Copy n words; from is shared. */
static inline void words_load(void *to, const void *from, size_t n)
{
	const shm_word *f = (const shm_word *)from;
	shm_word *t = (shm_word *)to;

	for (size_t i = 0; i < n; i++)
		t[i] = __atomic_load_n(&f[i], WORD_LOAD);
}

/*
 * The same where n is even and both are aligned to 8, in half as many loads where the processor has
 * 64-bit loads: a processor is slow to read in one load what it has just written in two stores.
 */
static inline void words_load_aligned(void *to, const void *from, size_t n)
{
#if __SIZEOF_LONG__ == 8
	const shm_double_word *f = (const shm_double_word *)from;
	shm_double_word *t = (shm_double_word *)to;

#pragma GCC unroll 6
	for (size_t i = 0; i < n / 2; i++)
		t[i] = __atomic_load_n(&f[i], WORD_LOAD);
#else
	words_load(to, from, n);
#endif
}

/* Copy n words; to is shared. */
static inline void words_store(void *to, const void *from, size_t n)
{
	const shm_word *f = (const shm_word *)from;
	shm_word *t = (shm_word *)to;

	for (size_t i = 0; i < n; i++)
		__atomic_store_n(&t[i], f[i], WORD_STORE);
}

/* Copy len bytes of text out of shared memory, word by word: it has room up to a whole one. */
static inline void words_load_text(char *to, const char *from, size_t len)
{
	uint32_t word;

	for (size_t i = 0; i < len; i += 4) {
		words_load(&word, from + i, 1);
		memcpy(to + i, &word, len - i < 4 ? len - i : 4);
	}
}

/* The same into shared memory; NUL fills the last word up. */
static inline void words_store_text(char *to, const char *from, size_t len)
{
	for (size_t i = 0; i < len; i += 4) {
		uint32_t word = 0;

		memcpy(&word, from + i, len - i < 4 ? len - i : 4);
		words_store(to + i, &word, 1);
	}
}
