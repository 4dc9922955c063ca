/* SPDX-License-Identifier: MIT */
/* Why getopt_long() refused an option, in words that name the option as it was typed. */
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "src/ground/text/refused.h"

static const char *long_name(const struct option *longs, int value)
{
	for (; longs->name; longs++)
		if (longs->val == value)
			return longs->name;
	return "";
}

/* Append to text the options that an abbreviation may stand for; returns how many there are. */
static unsigned add_meant(const struct option *longs, const char *typed, char *text, size_t size)
{
	size_t len = strcspn(typed, "="), used = strlen(text);
	unsigned meant = 0;

	for (; longs->name; longs++) {
		int n;

		if (strncmp(longs->name, typed, len) != 0 || used >= size)
			continue;
		n = snprintf(text + used, size - used, "%s--%s", meant++ ? " or " : "",
		             longs->name);
		used += n < 0 ? 0 : (size_t)n;
	}
	return meant;
}

static void refuse_long(const struct option *longs, const char *word, char *text, size_t size)
{
	snprintf(text, size, "%s may be ", word);
	if (add_meant(longs, word + 2, text, size) < 2)
		snprintf(text, size, "unknown option: %s", word);
}

void refused_option(int c, const struct option *longs, char *const *argv, char *text, size_t size)
{
	/* getopt has moved past a long option; past a short one only where it ends its word */
	const char *word = argv[optind - 1], *name = long_name(longs, optopt);
	bool is_long = strncmp(word, "--", 2) == 0;

	if (c == ':' && is_long)
		snprintf(text, size, "option without its argument: --%s", name);
	else if (c == ':')
		snprintf(text, size, "option without its argument: -%c", optopt);
	else if (!optopt)
		refuse_long(longs, word, text, size);
	else if (is_long && *name)
		snprintf(text, size, "--%s takes no value: %s", name, word);
	else if (optopt < 0 || optopt > '~')
		snprintf(text, size, "unknown option: - and the byte 0x%02X",
		         (unsigned)(unsigned char)optopt);
	else
		snprintf(text, size, "unknown option: -%c", optopt);
}
