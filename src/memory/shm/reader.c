/* SPDX-License-Identifier: MIT */
/* The reader's copy of a string signal's text, taken whole or not at all. */
#include "src/memory/shm/reader.h"

bool reader_text(const char *base, const struct ows_record *record, struct ows_sample *sample,
                 char *text, size_t size)
{
	for (int i = 0; i < READER_TRIES; i++) {
		uint32_t seq;
		const struct ows_slot *slot = reader_begin(record, &seq);
		const char *from = base + record->text_off +
		                   (size_t)(seq >> 1 & 1) * record->text_cap;
		size_t len;

		words_load_aligned(sample, &slot->sample, sizeof(*sample) / 4);
		len = sample->len < record->text_cap ? sample->len : record->text_cap;
		if (len >= size)
			len = size - 1;
		words_load_text(text, from, len);
		text[len] = '\0';
		if (reader_end(record, seq))
			return true;
	}
	return false;
}
