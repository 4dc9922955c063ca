/* SPDX-License-Identifier: MIT */
/* Which lines of a batch are sent at once. */
#include <string.h>

#include "src/faces/influx/part.h"

/* Bytes of whole lines from text on: at most most, but at least one line; most 0: all. */
static size_t lines_within(const char *text, size_t len, size_t most)
{
	const char *end;

	if (!most || len <= most)
		return len;
	end = memrchr(text, '\n', most);
	if (!end)
		end = memchr(text, '\n', len);
	return end ? (size_t)(end - text) + 1 : len;
}

size_t part_next(struct part *part, const char *batch, size_t batch_len)
{
	part->len = lines_within(batch + part->at, batch_len - part->at, part->most);
	return part->len;
}

void part_taken(struct part *part)
{
	part->at += part->len;
	part->len = 0;
}

bool part_halve(struct part *part, const char *batch)
{
	const char *first = memchr(batch + part->at, '\n', part->len);

	if (!first || (size_t)(first - batch) + 1 - part->at == part->len)
		return false;
	part->most = part->len / 2;
	part->len = 0;
	return true;
}

void part_begin(struct part *part)
{
	part->at = part->len = 0;
}
