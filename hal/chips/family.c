/* SPDX-License-Identifier: MIT */
/* What a family has its own way for: what its chips are called, what a restart makes void. */
#include <string.h>

#include "hal/chips/family.h"

const char *family_type(const struct device *device)
{
	const struct family *family = device->family;

	return family->type_of ? family->type_of(device) : family->type;
}

void family_forget(struct device *device)
{
	device_forget(device);
	if (device->family->forget)
		device->family->forget(device);
	else
		memset(device->own, 0, DEVICE_OWN);
}
