/* SPDX-License-Identifier: MIT */
#include "printable.h"

#include <stdio.h>
#include <string.h>

#define HEAD 300
static const char gap[] = { ' ', '.', '.', '.', ' ' };

/* Bytes of the character at text that has to go; 0: it may stay. */
static size_t harmful(const unsigned char *text, size_t left)
{
	if (text[0] < 0x20 || text[0] == 0x7f)
		return 1;
	if (left >= 2 && text[0] == 0xc2 && text[1] >= 0x80 && text[1] < 0xa0)
		return 2;
	if (left >= 3 && text[0] == 0xe2 &&
	    ((text[1] == 0x80 && text[2] >= 0xa8 && text[2] <= 0xae) ||
	     (text[1] == 0x81 && text[2] >= 0xa6 && text[2] <= 0xa9)))
		return 3;
	return 0;
}

size_t printable(char *text, size_t len)
{
	size_t to = 0;

	for (size_t from = 0; from < len;) {
		size_t bytes = harmful((const unsigned char *)text + from, len - from);

		text[to++] = bytes ? '?' : text[from];
		from += bytes ? bytes : 1;
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
