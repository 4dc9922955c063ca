/* SPDX-License-Identifier: MIT */
/* What a family has its own way for: what its chips are called, what a restart makes void. */
#include <string.h>

#include "hal/chips/family.h"

const char *family_type(const struct device *device)
{
	const struct family *family = device->family;

	return family->kind ? family->types[family->kind(device)] : family->type;
}

bool family_has(const struct device *device, const struct property *property)
{
	const struct family *family = device->family;
	unsigned kind = family->kind ? family->kind(device) : 1;
	uint32_t kinds = property->kinds;

	/* Those of every device have no kind. */
	if (!kinds && family->count && property >= family->properties &&
	    property < family->properties + family->count)
		kinds = family->plain;
	return !kinds || (kinds & KIND(kind ? kind : 1));
}

bool family_doubts(const struct device *device)
{
	const struct family *family = device->family;

	return family->kind && family->doubted & KIND(family->kind(device));
}

void family_forget(struct device *device)
{
	device_forget(device);
	if (device->family->forget)
		device->family->forget(device);
	else
		memset(device->own, 0, DEVICE_OWN);
}
