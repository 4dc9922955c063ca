/* SPDX-License-Identifier: MIT */
/* Names of signals as levels of topics, and back. */
#include <ctype.h>
#include <stdio.h>
#include <string.h>

#include "src/mqtt/topics.h"

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

static int digit(char c)
{
	return c >= '0' && c <= '9' ? c - '0' : c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
}

bool topic_is_command(const char *prefix, const char *topic, char name[TOPIC_NAME])
{
	size_t prefix_len = strlen(prefix), level_len, len = 0;
	char again[TOPIC_NAME];
	const char *level = topic + prefix_len + 1;

	if (strncmp(topic, prefix, prefix_len) != 0 || topic[prefix_len] != '/')
		return false;
	level_len = strcspn(level, "/");
	if (!level_len || level_len >= TOPIC_NAME || strcmp(level + level_len, "/set") != 0)
		return false;
	for (size_t i = 0; i < level_len; i++) {
		int high = level[i] == '%' && i + 2 < level_len ? digit(level[i + 1]) : -1;
		int low = high >= 0 ? digit(level[i + 2]) : -1;

		name[len++] = low >= 0 ? (char)(high * 16 + low) : level[i];
		i += low >= 0 ? 2 : 0;
	}
	name[len] = '\0';
	topic_escape(name, again);
	return strlen(again) == level_len && !strncmp(again, level, level_len);
}

void topic_id(const char *text, char *id, size_t size)
{
	size_t len = 0;

	for (; *text && len + 1 < size; text++)
		id[len++] = (char)(isalnum((unsigned char)*text) || *text == '-' ? *text : '_');
	id[len] = '\0';
}
