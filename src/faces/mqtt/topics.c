/* SPDX-License-Identifier: MIT */
/* Names of signals as levels of topics. */
#include <ctype.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "src/faces/mqtt/topics.h"

static bool is_reserved(const char *name)
{
	return !strcmp(name, TOPIC_STATE) || !strcmp(name, TOPIC_HEALTH) ||
	       !strcmp(name, TOPIC_CHIP);
}

void topic_escape(const char *name, char level[TOPIC_NAME])
{
	bool first = is_reserved(name);
	size_t len = 0;

	for (; *name && len + 4 <= TOPIC_NAME; name++, first = false)
		if (first || strchr("+#/%", *name))
			len += (size_t)snprintf(level + len, TOPIC_NAME - len, "%%%02X",
			                        (unsigned)(unsigned char)*name);
		else
			level[len++] = *name;
	level[len] = '\0';
}

void topic_slug(const char *text, char dash, char *id, size_t size)
{
	size_t len = 0;

	for (; *text && len + 1 < size; text++)
		if (isalnum((unsigned char)*text))
			id[len++] = (char)tolower((unsigned char)*text);
		else if (!len || id[len - 1] != dash)
			id[len++] = dash;
	id[len] = '\0';
}

void topic_id(const char *text, char *id, size_t size)
{
	size_t len = 0;

	for (; *text && len + 1 < size; text++)
		id[len++] = (char)(isalnum((unsigned char)*text) || *text == '-' ? *text : '_');
	id[len] = '\0';
}
