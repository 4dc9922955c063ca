/* SPDX-License-Identifier: MIT */
#include <assert.h>
#include <string.h>

#include "hal/wire/device.h"
#include "hal/wire/unfinished.h"

static bool has_base(const struct device *device, const void *which, unsigned at)
{
	return device->base_of == which && device->base_at == at;
}

bool unfinished_base(const struct device *device, const void *which, unsigned at, uint8_t *bytes,
                     size_t n)
{
	if (!has_base(device, which, at))
		return false;
	for (size_t i = 0; i < n; i++) {
		uint8_t asked = device->asked[i];
		bool done = ((bytes[i] ^ device->base[i]) & asked) == asked;

		/* some bits of the change alone make a number that nobody asked for */
		bytes[i] = done ? device->base[i] ^ asked : device->base[i];
	}
	return true;
}

void unfinished_begin(struct device *device, const void *which, unsigned at, const uint8_t *bytes,
                      const uint8_t *want, size_t n)
{
	assert(n <= sizeof(device->base));
	device->base_of = which;
	device->base_at = (uint16_t)at;
	memcpy(device->base, bytes, n);
	for (size_t i = 0; i < n; i++)
		device->asked[i] = bytes[i] ^ want[i];
}

void unfinished_end(struct device *device, const void *which, unsigned at)
{
	if (has_base(device, which, at))
		device->base_of = NULL;
}
