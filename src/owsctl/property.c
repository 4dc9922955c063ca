/* SPDX-License-Identifier: MIT */
/* Looks up the properties that paths name in the tables of the families. */
#include <stdio.h>
#include <string.h>

#include "hal/chips/family.h"
#include "hal/chips/find.h"
#include "hal/owfs/path.h"
#include "src/owsctl/property.h"
#include "src/show/names.h"

static bool begins(const struct property *property, const char *name, size_t len)
{
	return !strncmp(property->name, name, len) && property->name[len] == '/';
}

/* Is name the property itself, or the directory that it is in? */
static bool has(const struct family *family, const char *name, size_t len)
{
	const struct property *property = NULL;

	if (family_property(family, NULL, name, len))
		return true;
	while ((property = family_next(family, NULL, property)))
		if (begins(property, name, len))
			return true;
	return false;
}

/*
 * As with owsctl's other names, a name with more than a third of its letters wrong is another one.
 */
static void find_nearest(const struct family *family, const char *name, const char *extension,
                         char nearest[PROPERTY_NAME])
{
	size_t len = strlen(name);
	unsigned best = (unsigned)(len < 3 ? 2 : len / 3 + 1);
	const struct property *property = NULL;

	while ((property = family_next(family, NULL, property))) {
		unsigned distance = names_distance(name, property->name);

		if (property->type == PROPERTY_DIRECTORY || distance >= best)
			continue;
		best = distance;
		snprintf(nearest, PROPERTY_NAME, "%s%s", property->name, extension);
	}
}

bool property_known(const char *path, char nearest[PROPERTY_NAME])
{
	char name[PATH_LEN_MAX + 1], *dot;
	const struct family *family;
	struct path split;

	*nearest = '\0';
	if (path_split(path, strlen(path), &split) || !split.has_rom || !split.property.len ||
	    split.property.len >= sizeof(name))
		return true;
	family = family_of(split.rom[0]);
	if (family->code != split.rom[0])
		return true;
	memcpy(name, split.property.text, split.property.len);
	name[split.property.len] = '\0';
	dot = strrchr(name, '.');
	if (has(family, name, strlen(name)) || (dot && has(family, name, (size_t)(dot - name))))
		return true;
	if (dot)
		*dot = '\0';
	find_nearest(family, name, dot ? split.property.text + (dot - name) : "", nearest);
	return false;
}
