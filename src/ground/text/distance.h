/* SPDX-License-Identifier: MIT */
/* How near a word is to the one that a user probably meant. */
#pragma once

#include <stdbool.h>

/*
 * The least number of insertions, deletions, replacements and swaps of neighbours between two
 * words, of each its first TEXT_DISTANCE_MAX letters; case does not count.
 */
#define TEXT_DISTANCE_MAX 128
unsigned text_distance(const char *a, const char *b);

/*
 * A word with more than a third of its letters wrong is another word: text_distance() to one that
 * was meant is less.
 */
unsigned text_too_far(const char *word);
/* Is it nearer than *best, which begins as text_too_far(word)? Then *best is its distance. */
bool text_nearer(const char *word, const char *candidate, unsigned *best);
