/* SPDX-License-Identifier: MIT */
/* The reader's copy of a string signal's text, taken whole or not at all. */
#include <string.h>

#include "src/memory/shm/reader.h"

bool reader_text(const char *base, const struct ows_record *record, struct ows_sample *sample,
                 char *text, size_t size)
{
	for (int i = 0; i < READER_TRIES; i++) {
		uint32_t seq, word;
		const struct ows_slot *slot = reader_begin(record, &seq);
		const char *from = base + record->text_off +
		                   (size_t)(seq >> 1 & 1) * record->text_cap;
		size_t len;

		words_load_aligned(sample, &slot->sample, sizeof(*sample) / 4);
		len = sample->len < record->text_cap ? sample->len : record->text_cap;
		if (len >= size)
			len = size - 1;
		for (size_t n = 0; n < len; n += 4) {
			words_load(&word, from + n, 1);
			memcpy(text + n, &word, len - n < 4 ? len - n : 4);
		}
		text[len] = '\0';
		if (reader_end(record, seq))
			return true;
	}
	return false;
}
