/* SPDX-License-Identifier: MIT */
/*
 * The reader's half of the protocols of records and of entries (layout.h). No system call, no lock,
 * at most READER_TRIES rounds.
 */
#pragma once

#include <stdbool.h>

#include "src/memory/shm/word.h"
#include "src/public/ows_layout.h"

#ifndef READER_TRIES /* the model has fewer */
#define READER_TRIES 64
#endif

/* Begin a round: returns the slot to copy. */
static inline const struct ows_slot *reader_begin(const struct ows_record *record, uint32_t *seq)
{
	*seq = __atomic_load_n(&record->seq, __ATOMIC_ACQUIRE);
	return &record->slot[*seq >> 1 & 1];
}

/* Is the copy whole that was made since reader_begin()? */
static inline bool reader_end(const struct ows_record *record, uint32_t seq)
{
	word_fence(__ATOMIC_ACQUIRE);
	return word_get(&record->seq) - (seq & ~1u) <= 2;
}

/* Copy the first bytes of the newest slot: its sample, or all of it. */
static inline bool reader_bytes(const struct ows_record *record, void *to, size_t size)
{
	for (int i = 0; i < READER_TRIES; i++) {
		uint32_t seq;
		const struct ows_slot *slot = reader_begin(record, &seq);

		words_load_aligned(to, slot, size / 4);
		if (reader_end(record, seq))
			return true;
	}
	return false;
}

static inline bool reader_sample(const struct ows_record *record, struct ows_sample *sample)
{
	return reader_bytes(record, sample, sizeof(*sample));
}

static inline bool reader_slot(const struct ows_record *record, struct ows_slot *slot)
{
	return reader_bytes(record, slot, sizeof(*slot));
}

/*
 * Copy an entry of size bytes that changes as a whole: of the origins, controllers, shelves,
 * journals. False: owsd died while it wrote this entry.
 */
static inline bool reader_entry(const void *from, void *entry, size_t size)
{
	const shm_word *word = (const shm_word *)from;

	for (int i = 0; i < READER_TRIES; i++) {
		uint32_t seq = __atomic_load_n(word, __ATOMIC_ACQUIRE);

		words_load_aligned(entry, from, size / 4);
		word_fence(__ATOMIC_ACQUIRE);
		if (seq % 2 == 0 && __atomic_load_n(word, __ATOMIC_RELAXED) == seq)
			return true;
	}
	return false;
}

/* Copies at most size - 1 bytes of text and a NUL; base is the segment's. */
bool reader_text(const char *base, const struct ows_record *record, struct ows_sample *sample,
                 char *text, size_t size);
