/* SPDX-License-Identifier: MIT */
/* Texts of latches, flags and alarm conditions: what they say, and whether they agree. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "src/daemon/engine/alarm/alarm_text.h"
#include "src/ground/signal/value.h"

/* One entry of a list, as alarm_non_zero(). */
static int entry_non_zero(const char *text, size_t len)
{
	static const char *const yes[] = {"yes", "on"}, *const no[] = {"no", "off"};
	size_t begin = 0, end = len;
	char entry[32];
	int64_t value;
	uint8_t quality;

	while (begin < end && text[begin] == ' ')
		begin++;
	while (end > begin && text[end - 1] == ' ')
		end--;
	if (begin == end || end - begin >= sizeof(entry))
		return -EILSEQ;
	memcpy(entry, text + begin, end - begin);
	entry[end - begin] = '\0';
	for (int k = 0; k < 2; k++) {
		if (strcmp(entry, yes[k]) == 0)
			return 1;
		if (strcmp(entry, no[k]) == 0)
			return 0;
	}
	if (value_from_text(OWS_DOUBLE, entry, strlen(entry), &value, &quality))
		return -EILSEQ;
	return value_number(OWS_DOUBLE, value) != 0;
}

int alarm_non_zero(const char *text, size_t len)
{
	bool any = false;

	while (true) {
		const char *comma = memchr(text, ',', len);
		size_t n = comma ? (size_t)(comma - text) : len;
		int set = entry_non_zero(text, n);

		if (set < 0)
			return set;
		any |= set;
		if (!comma)
			return any;
		len -= n + 1;
		text = comma + 1;
	}
}

uint32_t alarm_channels(const char *text)
{
	uint32_t channels = 0;
	int64_t number;
	uint8_t quality;

	if (!strchr(text, ',')) {
		if (value_from_text(OWS_DWORD, text, strlen(text), &number, &quality) || !number)
			return 1;
		return (uint32_t)number;
	}
	for (unsigned k = 0;; k++) {
		size_t n = strcspn(text, ",");

		if (entry_non_zero(text, n) > 0)
			channels |= UINT32_C(1) << (k < 31 ? k : 31);
		if (!text[n]) /* the set one of a long list may be cut off */
			return channels ? channels : 1;
		text += n + 1;
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
