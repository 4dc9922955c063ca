/* SPDX-License-Identifier: MIT */
/* Text that comes from elsewhere, made fit for a terminal or a log. */
#include <stdio.h>
#include <string.h>

#include "src/ground/signal/utf8.h"
#include "src/ground/text/printable.h"

#define HEAD 300
static const char gap[] = {' ', '.', '.', '.', ' '};

size_t printable(char *text, size_t len)
{
	const char *from = text;
	size_t to = 0;

	while (len > 0) {
		const char *at = from;

		if (utf8_disturbs(utf8_next(&from, &len))) {
			text[to++] = '?';
		} else {
			memmove(text + to, at, (size_t)(from - at));
			to += (size_t)(from - at);
		}
	}
	return to;
}

void printable_quoted(char *text)
{
	while ((text = strchr(text, '"')))
		*text = '\'';
}

size_t printable_cut(const char *text, size_t most)
{
	size_t len = strnlen(text, most), start = len;

	if (len < most)
		return len;
	while (start > 0 && len - start < 3 && ((unsigned char)text[start - 1] & 0xc0) == 0x80)
		start--;
	if (start > 0 && (unsigned char)text[start - 1] >= 0xc0) {
		unsigned char lead = (unsigned char)text[start - 1];
		size_t want = lead >= 0xf0 ? 4 : lead >= 0xe0 ? 3 : 2;

		if (len - (start - 1) < want)
			return start - 1;
	}
	return len;
}

static int is_inside_character(char c)
{
	return ((unsigned char)c & 0xc0) == 0x80;
}

static void shorten(char *text, size_t len)
{
	size_t head = HEAD, tail = len - (PRINTABLE_LINE - HEAD - sizeof(gap));

	while (head && is_inside_character(text[head]))
		head--;
	while (is_inside_character(text[tail]))
		tail++;
	memcpy(text + head, gap, sizeof(gap));
	memmove(text + head + sizeof(gap), text + tail, len - tail + 1);
}

char *printable_line(const char *format, va_list args)
{
	char *text;
	int len = vasprintf(&text, format, args);

	if (len < 0)
		return NULL;
	if (len > PRINTABLE_LINE)
		shorten(text, (size_t)len);
	text[printable(text, strlen(text))] = '\0';
	return text;
}
