/* SPDX-License-Identifier: MIT */
/* The columns that a text takes on a terminal, and the removal of what must not reach one. */
#include <string.h>

#include "src/faces/show/text.h"
#include "src/ground/signal/utf8.h"

struct range {
	int32_t first, last;
};

static bool in_ranges(const struct range *ranges, size_t n, int32_t c)
{
	for (size_t i = 0; i < n; i++)
		if (c >= ranges[i].first && c <= ranges[i].last)
			return true;
	return false;
}

/* Columns of a character: 0 combining, 2 wide, else 1. */
static unsigned text_columns_of(int32_t c)
{
	static const struct range none[] = {
		{0x0300, 0x036f}, {0x0483, 0x0489}, {0x0591, 0x05bd}, {0x064b, 0x065f},
		{0x1ab0, 0x1aff}, {0x1dc0, 0x1dff}, {0x200b, 0x200f}, {0x20d0, 0x20ff},
		{0xfe00, 0xfe0f}, {0xfe20, 0xfe2f},
	};
	static const struct range wide[] = {
		{0x1100, 0x115f},   {0x2e80, 0x303e},   {0x3041, 0xa4cf},   {0xac00, 0xd7a3},
		{0xf900, 0xfaff},   {0xfe30, 0xfe6f},   {0xff00, 0xff60},   {0xffe0, 0xffe6},
		{0x1f300, 0x1f64f}, {0x1f680, 0x1f6ff}, {0x1f900, 0x1f9ff}, {0x20000, 0x3fffd},
	};

	if (c < 0x300)
		return 1;
	if (in_ranges(none, sizeof(none) / sizeof(none[0]), c))
		return 0;
	return in_ranges(wide, sizeof(wide) / sizeof(wide[0]), c) ? 2 : 1;
}

unsigned text_columns(const char *text)
{
	size_t len = strlen(text);
	unsigned columns = 0;

	while (len > 0)
		columns += text_columns_of(utf8_next(&text, &len));
	return columns;
}

unsigned text_clean(const char *text, size_t len, unsigned columns, char *out, size_t room)
{
	size_t size = 0, mark = 0; /* mark: where '~' goes if the rest does not fit */
	unsigned used = 0, mark_used = 0;

	if (room == 0)
		return 0;
	while (len > 0) {
		const char *at = text;
		int32_t c = utf8_next(&text, &len);
		size_t bytes = (size_t)(text - at);
		unsigned width;

		if (utf8_disturbs(c)) {
			at = "?";
			bytes = 1;
			c = '?';
		}
		width = text_columns_of(c);
		if (used + width > columns || size + bytes + 1 > room) {
			if (columns > 0 && room > 1) {
				out[mark] = '~';
				size = mark + 1;
				used = mark_used + 1;
			}
			break;
		}
		memcpy(out + size, at, bytes);
		size += bytes;
		used += width;
		if (used + 1 <= columns && size + 2 <= room) {
			mark = size;
			mark_used = used;
		}
	}
	out[size] = '\0';
	return used;
}
