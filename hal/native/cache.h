/* SPDX-License-Identifier: MIT */
/*
 * What was read lately: texts of properties, bounded, found by device, property and extension. An
 * entry ends with its time, or when the device's `changes` has grown.
 */
#pragma once

#include <stdint.h>

#define CACHE_TEXT_MAX 128

struct device;
struct property;

struct cache_entry {
	const struct device *device; /* NULL: free */
	const struct property *property;
	int extension;
	uint32_t changes;
	int64_t until_ns, measured_ns;
	double number;
	uint8_t kind; /* enum bus_kind */
	uint8_t len;
	uint8_t text[CACHE_TEXT_MAX];
};

struct cache {
	struct cache_entry *entries;
};

int cache_create(struct cache *cache);
void cache_destroy(struct cache *cache);
/* NULL: not there, or too old. */
const struct cache_entry *cache_find(struct cache *cache, const struct device *device,
                                     const struct property *property, int extension, int64_t now);
/* A place for it; the caller fills the rest from until_ns on. */
struct cache_entry *cache_add(struct cache *cache, const struct device *device,
                              const struct property *property, int extension);
