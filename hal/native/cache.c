/* SPDX-License-Identifier: MIT */
/* The answers that the native bus keeps for reads that need not be fresh. */
#include <assert.h>
#include <errno.h>
#include <stdlib.h>

#include "hal/chips/format.h"
#include "hal/native/cache.h"
#include "hal/wire/device.h"

#define SETS 256
#define WAYS 4

int cache_create(struct cache *cache)
{
	cache->entries = calloc(SETS * WAYS, sizeof(*cache->entries));
	return cache->entries ? 0 : -ENOMEM;
}

void cache_destroy(struct cache *cache)
{
	free(cache->entries);
}

static struct cache_entry *set_of(struct cache *cache, const struct device *device,
                                  const struct property *property, int extension)
{
	uintptr_t key = (uintptr_t)device / sizeof(*device) * 31 + (uintptr_t)property / 16 * 7 +
	                (uintptr_t)extension_element(extension);

	return cache->entries + (key ^ key >> 8) % SETS * WAYS;
}

static bool cache_is(const struct cache_entry *entry, const struct device *device,
                     const struct property *property, int extension)
{
	return entry->device == device && entry->property == property &&
	       entry->extension == extension;
}

const struct cache_entry *cache_find(struct cache *cache, const struct device *device,
                                     const struct property *property, int extension, int64_t now)
{
	struct cache_entry *entry = set_of(cache, device, property, extension);

	for (int way = 0; way < WAYS; way++, entry++) {
		if (!cache_is(entry, device, property, extension))
			continue;
		return entry->changes == device->changes && now < entry->until_ns ? entry : NULL;
	}
	return NULL;
}

struct cache_entry *cache_add(struct cache *cache, const struct device *device,
                              const struct property *property, int extension)
{
	struct cache_entry *set = set_of(cache, device, property, extension), *best = set;

	for (int way = 0; way < WAYS; way++) {
		if (cache_is(&set[way], device, property, extension)) {
			best = &set[way];
			break;
		}
		if (!set[way].device || set[way].until_ns < best->until_ns)
			best = &set[way];
	}
	assert(device);
	best->device = device;
	best->property = property;
	best->extension = extension;
	best->changes = device->changes;
	return best;
}
