/* SPDX-License-Identifier: MIT */
/* Text that comes from elsewhere, made fit for a terminal or a log. */
#include <stdio.h>
#include <string.h>

#include "src/signal/utf8.h"
#include "src/text/printable.h"

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
