/* SPDX-License-Identifier: MIT */
/* The columns that a text takes on a terminal, and the removal of what must not reach one. */
#include <stdlib.h>
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

static bool only_ascii;

void text_only_ascii(bool only)
{
	only_ascii = only;
}

bool text_locale_is_ascii(void)
{
	static const char *const names[] = {"LC_ALL", "LC_CTYPE", "LANG"};
	const char *set = NULL;

	for (size_t i = 0; i < sizeof(names) / sizeof(names[0]) && (!set || !*set); i++)
		set = getenv(names[i]);
	return set && *set && !strcasestr(set, "UTF-8") && !strcasestr(set, "UTF8");
}

/* The one character of ASCII that stands for c. */
static const char *as_ascii(int32_t c)
{
	static const struct {
		int32_t first, last;
		const char *text;
	} known[] = {
		{0xb0, 0xb0, "o"},     {0xb2, 0xb2, "2"},     {0xb3, 0xb3, "3"},
		{0xb5, 0xb5, "u"},     {0x3bc, 0x3bc, "u"},   {0xd7, 0xd7, "x"},
		{0x3a9, 0x3a9, "O"},   {0x2126, 0x2126, "O"}, {0x2010, 0x2015, "-"},
		{0x2500, 0x2500, "-"}, {0x2800, 0x2800, " "}, {0x2801, 0x28ff, "*"},
	};

	for (size_t i = 0; i < sizeof(known) / sizeof(known[0]); i++)
		if (c >= known[i].first && c <= known[i].last)
			return known[i].text;
	return text_columns_of(c) ? "?" : "";
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
		} else if (only_ascii && c > '~') {
			at = as_ascii(c);
			bytes = strlen(at);
			c = *at ? *at : c;
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
