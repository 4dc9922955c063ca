/* SPDX-License-Identifier: MIT */
/* The device table: places, and what is known of each chip. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "hal/owfs/path.h"
#include "hal/wire/device.h"

int device_table_create(struct device_table *table)
{
	table->count = 0;
	table->devices = calloc(DEVICE_MAX, sizeof(*table->devices));
	table->own = calloc(DEVICE_MAX, sizeof(*table->own));
	table->aliases = calloc(DEVICE_MAX, sizeof(*table->aliases));
	return table->devices && table->own && table->aliases ? 0 : -ENOMEM;
}

void device_table_destroy(struct device_table *table)
{
	free(table->devices);
	free(table->own);
	free(table->aliases);
}

struct device *device_find(struct device_table *table, const uint8_t rom[8])
{
	for (unsigned i = 0; i < table->count; i++)
		if (memcmp(table->devices[i].rom, rom, 7) == 0)
			return &table->devices[i];
	return NULL;
}

static struct device *free_device(struct device_table *table)
{
	if (table->count < DEVICE_MAX)
		return &table->devices[table->count++];
	for (unsigned i = 0; i < DEVICE_MAX; i++) {
		struct device *device = &table->devices[i];

		if (!device->present && !device->locked && !device->named && !table->aliases[i][0])
			return device;
	}
	return NULL;
}

struct device *device_add(struct device_table *table, const uint8_t rom[8],
                          const struct family *family, unsigned channel)
{
	struct device *device = device_find(table, rom);

	if (!device) {
		device = free_device(table);
		if (!device)
			return NULL;
		uint32_t changes = device->changes + 1;
		memset(device, 0, sizeof(*device));
		device->own = table->own[device - table->devices];
		memset(device->own, 0, DEVICE_OWN);
		memcpy(device->rom, rom, 8);
		device->family = family;
		device->table = table;
		device->changes = changes;
	}
	device->channel = (uint8_t)channel;
	return device;
}

void device_forget(struct device *device)
{
	device->changes++;
	device->kind = 0;
	device->power = POWER_UNKNOWN;
	device->shadow_known = false;
	device->base_of = NULL;
}

static char *alias_of(const struct device *device)
{
	return device->table->aliases[device - device->table->devices];
}

const char *device_alias(const struct device *device)
{
	return alias_of(device);
}

struct device *device_by_alias(struct device_table *table, const char *name, size_t len)
{
	if (len == 0 || len > DEVICE_ALIAS_MAX)
		return NULL;
	for (unsigned i = 0; i < table->count; i++)
		if (strlen(table->aliases[i]) == len && memcmp(table->aliases[i], name, len) == 0)
			return &table->devices[i];
	return NULL;
}

int device_set_alias(struct device *device, const char *text, size_t len)
{
	static const char *const words[] = {"uncached",   "alarm",     "settings",     "system",
	                                    "statistics", "structure", "simultaneous", "interface"};
	char *alias = alias_of(device);
	uint8_t rom[8];

	for (; len && *text == ' '; text++)
		len--;
	if (len > DEVICE_ALIAS_MAX || rom_parse(text, len, rom) != -EINVAL)
		return -EINVAL;
	for (size_t i = 0; i < len; i++)
		if (text[i] == '/' || (unsigned char)text[i] < ' ')
			return -EINVAL;
	if (len >= 4 && strncasecmp(text, "bus.", 4) == 0)
		return -EINVAL;
	for (size_t i = 0; i < sizeof(words) / sizeof(words[0]); i++)
		if (strlen(words[i]) == len && strncasecmp(words[i], text, len) == 0)
			return -EINVAL;
	struct device *other = device_by_alias(device->table, text, len);
	if (other)
		alias_of(other)[0] = '\0';
	memcpy(alias, text, len);
	alias[len] = '\0';
	return 0;
}
