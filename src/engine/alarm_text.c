/* SPDX-License-Identifier: MIT */
#include "alarm_text.h"

#include "alarm.h"

#include "../signal/value.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* 1, 0, or -EILSEQ: blanks trimmed; a list is non-zero if one entry is. */
int alarm_non_zero(const char *text, size_t len)
{
	static const char *const yes[] = { "yes", "on" }, *const no[] = { "no", "off" };
	bool any = false;
	char entry[32];

	while (true) {
		const char *comma = memchr(text, ',', len);
		size_t n = comma ? (size_t)(comma - text) : len, begin = 0, end = n;
		int64_t value;
		uint8_t quality;
		bool word = false;

		while (begin < end && text[begin] == ' ')
			begin++;
		while (end > begin && text[end - 1] == ' ')
			end--;
		if (begin == end || end - begin >= sizeof(entry))
			return -EILSEQ;
		memcpy(entry, text + begin, end - begin);
		entry[end - begin] = '\0';
		for (int k = 0; k < 2; k++) {
			word |= strcmp(entry, yes[k]) == 0 || strcmp(entry, no[k]) == 0;
			any |= strcmp(entry, yes[k]) == 0;
		}
		if (!word) {
			if (value_from_text(OWS_DOUBLE, entry, strlen(entry), &value, &quality))
				return -EILSEQ;
			any |= value_number(OWS_DOUBLE, value) != 0;
		}
		if (!comma)
			return any;
		len -= n + 1;
		text = comma + 1;
	}
}

void alarm_trim(char *to, size_t size, const char *text, size_t len)
{
	while (len && *text == ' ') {
		text++;
		len--;
	}
	snprintf(to, size, "%.*s", (int)len, text);
}

bool alarm_as_set(const char *text, size_t len, const char *value)
{
	char is[ALARM_TEXT];
	double a, b;
	char *end_a, *end_b;

	alarm_trim(is, sizeof(is), text, len);
	a = strtod(is, &end_a);
	b = strtod(value, &end_b);
	if (*is && *value && !*end_a && !*end_b)
		return a == b;
	return strcmp(is, value) == 0;
}
