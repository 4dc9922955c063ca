/* SPDX-License-Identifier: MIT */
/* The distance between two words, to say which one was probably meant. */
#include <ctype.h>
#include <string.h>

#include "src/ground/text/distance.h"

static unsigned smaller(unsigned a, unsigned b)
{
	return a < b ? a : b;
}

static bool same_letter(char a, char b)
{
	return tolower((unsigned char)a) == tolower((unsigned char)b);
}

unsigned text_distance(const char *a, const char *b)
{
	/* three rows of the table of distances between all beginnings of a and of b */
	unsigned rows[3][TEXT_DISTANCE_MAX + 1];
	size_t la = strnlen(a, TEXT_DISTANCE_MAX), lb = strnlen(b, TEXT_DISTANCE_MAX);

	for (size_t j = 0; j <= lb; j++)
		rows[0][j] = (unsigned)j;
	for (size_t i = 1; i <= la; i++) {
		unsigned *row = rows[i % 3];
		const unsigned *above = rows[(i + 2) % 3], *above2 = rows[(i + 1) % 3];

		row[0] = (unsigned)i;
		for (size_t j = 1; j <= lb; j++) {
			row[j] = smaller(smaller(above[j] + 1, row[j - 1] + 1),
			                 above[j - 1] + !same_letter(a[i - 1], b[j - 1]));
			if (i > 1 && j > 1 && same_letter(a[i - 1], b[j - 2]) &&
			    same_letter(a[i - 2], b[j - 1]))
				row[j] = smaller(row[j], above2[j - 2] + 1);
		}
	}
	return rows[la % 3][lb];
}

unsigned text_too_far(const char *word)
{
	size_t len = strlen(word);

	return (unsigned)(len < 3 ? 2 : len / 3 + 1);
}

bool text_nearer(const char *word, const char *candidate, unsigned *best)
{
	unsigned distance = text_distance(word, candidate);
	bool nearer = distance < *best;

	*best = nearer ? distance : *best;
	return nearer;
}
