/* SPDX-License-Identifier: MIT */
/* What a family has its own way for: what its chips are called, what a restart makes void. */
#include <string.h>

#include "hal/chips/family.h"

const char *family_type(const struct device *device)
{
	const struct family *family = device->family;

	return family->types ? family->types[device->kind] : family->type;
}

const char *family_identity(const struct device *device)
{
	const struct family *family = device->family;

	if (family->name || device->identity)
		return device->identity;
	return family->several && !device->kind ? NULL : family_type(device);
}

bool family_untold(const struct device *device)
{
	return device->family->several && !device->kind;
}

/* All kinds that a chip of the family may turn out to be. */
static uint32_t candidates(const struct family *family)
{
	uint32_t kinds = family->plain;

	for (unsigned i = 0; i < family->count; i++)
		kinds |= family->properties[i].kinds;
	return kinds & ~(family->doubted | KIND(0));
}

bool family_has(const struct device *device, const struct property *property)
{
	const struct family *family = device->family;
	unsigned kind = family->several ? device->kind : 1;
	uint32_t kinds = property->kinds, all;

	/* Those of every device have no kind. */
	if (!kinds && family->count && property >= family->properties &&
	    property < family->properties + family->count)
		kinds = family->plain;
	if (!kinds)
		return true;
	all = kind ? KIND(kind) : candidates(family);
	return (kinds & all) == all;
}

bool family_doubts(const struct device *device)
{
	return device->family->doubted & KIND(device->kind);
}

void family_forget(struct device *device)
{
	device_forget(device);
	if (device->family->forget)
		device->family->forget(device);
	else
		memset(device->own, 0, DEVICE_OWN);
}
