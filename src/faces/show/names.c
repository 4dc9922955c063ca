/* SPDX-License-Identifier: MIT */
/* Names of signals as the user writes them: patterns, and the nearest name of the table. */
#include <fnmatch.h>
#include <stdio.h>
#include <string.h>

#include "src/faces/show/names.h"
#include "src/ground/text/distance.h"

static int find_record(void *ctx, const char *name, size_t len)
{
	struct ows *h = ctx;

	for (int i = 0; i < ows_count(h); i++) {
		struct ows_info info;

		if (ows_info(h, i, &info) == 0 && strlen(info.name) == len &&
		    memcmp(info.name, name, len) == 0)
			return i + 1;
	}
	return -1;
}

int names_lookup(struct ows *h, const char *instance, const char *name, int *signal,
                 enum attribute *attribute)
{
	int record = attribute_lookup(instance, name, find_record, h, attribute);

	if (record < 0)
		return record;
	*signal = record - 1;
	return 0;
}

bool names_info(struct ows *h, const char *instance, const char *name, struct ows_info *info)
{
	enum attribute attribute;
	int signal;

	return names_lookup(h, instance, name, &signal, &attribute) == 0 &&
	       attribute == ATTR_VALUE && ows_info(h, signal, info) == 0;
}

bool names_match(const char *name, char *const *patterns, int count)
{
	for (int i = 0; i < count; i++)
		if (fnmatch(patterns[i], name, 0) == 0)
			return true;
	return count == 0;
}

bool names_some(struct ows *h, char *const *patterns, int count)
{
	struct ows_info info;

	for (int i = 0; ows_info(h, i, &info) == 0; i++)
		if (names_match(info.name, patterns, count))
			return true;
	return false;
}

struct nearest {
	const char *name;
	char *best;
	unsigned distance;
};

static void consider(struct nearest *nearest, const char *candidate)
{
	unsigned distance = text_distance(nearest->name, candidate);

	if (distance < nearest->distance) {
		nearest->distance = distance;
		snprintf(nearest->best, NAMES_MAX, "%s", candidate);
	}
}

static void consider_attributes(struct nearest *nearest, const char *signal, bool driver)
{
	for (int i = 0; i < ATTR_COUNT; i++) {
		const struct attribute_def *def = &attribute_table[i];
		char candidate[NAMES_MAX];

		if (def->driver != driver)
			continue;
		snprintf(candidate, sizeof(candidate), "%s%s", signal, def->name);
		consider(nearest, candidate);
	}
}

bool names_nearest(struct ows *h, const char *name, char best[NAMES_MAX])
{
	struct nearest nearest = {.name = name, .best = best, .distance = text_too_far(name)};

	if (strlen(name) >= NAMES_MAX)
		return false;
	best[0] = '\0';
	for (int i = 0; i < ows_count(h); i++) {
		struct ows_info info;
		size_t size;

		if (ows_info(h, i, &info) != 0)
			continue;
		consider(&nearest, info.name);
		size = strlen(info.name);
		if (strncmp(info.name, name, size) == 0 && name[size] == '_')
			consider_attributes(&nearest, info.name, false);
	}
	if (name[0] == '_')
		consider_attributes(&nearest, "", true);
	return best[0] != '\0';
}
