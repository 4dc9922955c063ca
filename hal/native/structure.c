/* SPDX-License-Identifier: MIT */
/* /structure: what properties a family has, as owserver states them. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "hal/chips/find.h"
#include "hal/chips/format.h"
#include "hal/native/structure.h"

const struct family *structure_family(const char *path, size_t len, size_t *used)
{
	const struct family *family;
	char code[3];

	*used = 2;
	if (len < 2 || (len > 2 && path[2] != '/'))
		return NULL;
	for (unsigned n = 0; (family = family_nth(n)); n++) {
		snprintf(code, sizeof(code), "%02X", family->code);
		if (strncasecmp(code, path, 2) == 0)
			return family;
	}
	return NULL;
}

static unsigned whole_size(const struct property *property, int extension)
{
	unsigned size = property_size(property), count = property->array.count;

	if (extension == EXTENSION_BYTE)
		return 12;
	if (extension != EXTENSION_ALL)
		return size;
	return property->type == PROPERTY_BINARY ? size * count : size * count + count - 1;
}

/* As owserver counts them where they cannot be counted, too. */
static int elements(const struct property *property)
{
	if (property->array.index == INDEX_NONE)
		return 1;
	if (property->array.count == 0)
		return property->array.index == INDEX_LETTERS ? -1 : 0;
	return property->array.count;
}

int structure_print(const struct property *property, int extension, char *text, size_t room)
{
	static const char *const access[] = {"oo", "ro", "wo", "rw"};
	char type = property->type == PROPERTY_BITS ? 'y' : (char)property->type;
	int n = snprintf(text, room, "%c,%.6d,%.6d,%s,%.6u,%c,", type,
	                 extension == EXTENSION_NONE   ? 0
	                 : extension == EXTENSION_WORD ? 0
	                 : extension < 0               ? extension
	                                               : extension_element(extension),
	                 elements(property), access[property->access & 3],
	                 whole_size(property, extension), property->life);
	return n < 0 || (size_t)n >= room ? -EMSGSIZE : n;
}
