/* SPDX-License-Identifier: MIT */
/* Families and their properties: found by code and by name, listed in order. */
#include <string.h>

#include "hal/chips/find.h"

static const struct family *const families[] = {
#define FAMILY(code) &family_##code,
#include "hal/chips/families.h"
#undef FAMILY
};
#define FAMILIES (sizeof(families) / sizeof(families[0]))

const struct family *family_of(uint8_t code)
{
	for (size_t i = 0; i < FAMILIES; i++)
		if (families[i]->code == code)
			return families[i];
	return &family_common;
}

const struct family *family_nth(unsigned n)
{
	return n < FAMILIES ? families[n] : NULL;
}

static bool is_visible(const struct property *property, const struct device *device)
{
	return !device || family_has(device, property);
}

static int order(const char *name, size_t len, const char *other)
{
	int order = strncmp(name, other, len);

	return order ? order : -(other[len] != '\0');
}

/* The first that is not below the name. Tables of families are sorted. */
static unsigned first_from(const struct family *family, const char *name, size_t len)
{
	unsigned low = 0, high = family->count;

	while (low < high) {
		unsigned middle = (low + high) / 2;

		if (order(name, len, family->properties[middle].name) > 0)
			low = middle + 1;
		else
			high = middle;
	}
	return low;
}

static const struct property *row_by_name(const struct family *family, const char *name, size_t len)
{
	unsigned i = family->is_virtual ? 0 : first_from(family, name, len);

	for (; i < family->count; i++) {
		if (order(name, len, family->properties[i].name) == 0)
			return &family->properties[i];
		if (!family->is_virtual)
			break;
	}
	return NULL;
}

const struct property *family_property(const struct family *family, const struct device *device,
                                       const char *name, size_t len)
{
	const struct property *property = row_by_name(family, name, len);

	if (!property && !family->is_virtual)
		property = row_by_name(&family_common, name, len);
	if (!property || is_visible(property, device))
		return property;
	/* the request looks which chip it is, and is refused then */
	bool unknown = family->several && (!device->kind || family_doubts(device));

	return unknown ? property : NULL;
}

/* The first of the table behind prev, if it comes before best. */
static const struct property *nearer(const struct family *family, const struct device *device,
                                     const struct property *prev, const struct property *best)
{
	bool sorted = !family->is_virtual;

	for (unsigned i = sorted && prev ? first_from(family, prev->name, strlen(prev->name)) : 0;
	     i < family->count &&
	     !(sorted && best && strcmp(family->properties[i].name, best->name) > 0);
	     i++) {
		const struct property *property = &family->properties[i];

		if (prev && strcmp(property->name, prev->name) <= 0)
			continue;
		if (best && strcmp(property->name, best->name) >= 0)
			continue;
		if (is_visible(property, device))
			best = property;
	}
	return best;
}

const struct property *family_next(const struct family *family, const struct device *device,
                                   const struct property *prev)
{
	const struct property *best = nearer(family, device, prev, NULL);

	if (family->is_virtual || family == &family_common)
		return best;
	return nearer(&family_common, device, prev, best);
}
