/* SPDX-License-Identifier: MIT */
/* The lines that owdump and busdump print, for paths and values. */
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/kernel/lines.h"

#define LINE_ROOM 2400 /* 512 bytes as \xNN, and a path */

void lines_answer(const char *path, int ret, const void *data, size_t len)
{
	const unsigned char *bytes = data;

	printf("%s\t", path);
	if (ret < 0)
		printf("ret=%d", ret);
	for (size_t i = 0; ret >= 0 && i < len; i++) {
		if (bytes[i] < ' ' || bytes[i] > '~' || bytes[i] == '\\')
			printf("\\x%02x", bytes[i]);
		else
			putchar(bytes[i]);
	}
	putchar('\n');
	fflush(stdout);
}

void lines_written(const char *path, int ret)
{
	printf("%s\tret=%d\n", path, ret < 0 ? ret : 0);
	fflush(stdout);
}

static bool next(char line[LINE_ROOM])
{
	do {
		if (!fgets(line, LINE_ROOM, stdin))
			return false;
		line[strcspn(line, "\n")] = '\0';
	} while (!line[0] || line[0] == '#');
	return true;
}

void lines_of_paths(void (*read)(const char *path))
{
	char line[LINE_ROOM];

	while (next(line))
		read(line);
}

static size_t unescape(char *text)
{
	size_t n = 0;

	for (const char *p = text; *p; n++) {
		if (p[0] == '\\' && p[1] == 'x' && p[2] && p[3]) {
			const char digits[3] = {p[2], p[3], '\0'};

			text[n] = (char)strtoul(digits, NULL, 16);
			p += 4;
		} else {
			text[n] = *p++;
		}
	}
	return n;
}

void lines_of_values(void (*write)(const char *path, const uint8_t *value, size_t len))
{
	char line[LINE_ROOM], *value;

	while (next(line)) {
		value = strchr(line, ' ');
		if (!value)
			continue;
		*value++ = '\0';
		write(line, (const uint8_t *)value, unescape(value));
	}
}
