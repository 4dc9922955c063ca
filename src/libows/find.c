/* SPDX-License-Identifier: MIT */
/* The names that a program looks up: their ids, and the record of each id in the present image. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "src/libows/find.h"
#include "src/libows/handle.h"
#include "src/libows/map.h"

static int find_name(void *ctx, const char *name, size_t len)
{
	return map_find(ctx, name, len);
}

/* Make room for one more element; *array stays valid when there is no memory. */
static int grow(void **array, unsigned count, unsigned *room, size_t size)
{
	unsigned more = *room ? *room * 2 : 16;
	void *grown;

	if (count < *room)
		return 0;
	grown = realloc(*array, more * size);
	if (grown == NULL)
		return -ENOMEM;
	*array = grown;
	*room = more;
	return 0;
}

static int find_memory(struct ows *h, const char *signal)
{
	void *array = h->memories;

	for (unsigned i = 0; i < h->memory_count; i++)
		if (strcmp(h->memories[i].name, signal) == 0)
			return (int)i;
	if (grow(&array, h->memory_count, &h->memory_room, sizeof(*h->memories)))
		return -ENOMEM;
	h->memories = array;
	h->memories[h->memory_count] = (struct ows_memory){.name = strdup(signal)};
	if (h->memories[h->memory_count].name == NULL)
		return -ENOMEM;
	return (int)h->memory_count++;
}

static bool needs_memory(enum attribute attribute)
{
	return attribute == ATTR_ALARM || attribute == ATTR_DGNRESET ||
	       attribute == ATTR_WRITE_ONE_SHOT || attribute == ATTR_DRIVER_DGNRESET;
}

int find_resolve(struct ows *h, struct ows_id *id)
{
	id->record = attribute_lookup(h->instance, id->name, find_name, &h->map, &id->attribute);
	if (id->record < 0) {
		id->record = -1;
		return -ENOENT;
	}
	id->stale_after_ns = map_info(&h->map, (uint32_t)id->record)->stale_after_ns;
	if (needs_memory(id->attribute)) {
		int memory = find_memory(h, map_name(&h->map, (uint32_t)id->record));

		if (memory < 0) {
			id->record = -1;
			return memory;
		}
		id->memory = (unsigned)memory;
	}
	return 0;
}

int ows_find(struct ows *h, const char *name)
{
	struct ows_id id = {0};
	void *array = h->ids;
	int err;

	for (unsigned i = 0; i < h->id_count; i++)
		if (strcmp(h->ids[i].name, name) == 0)
			return h->ids[i].record >= 0 ? (int)i : -ENOENT;
	if (grow(&array, h->id_count, &h->id_room, sizeof(*h->ids)))
		return -ENOMEM;
	h->ids = array;
	id.name = strdup(name);
	if (id.name == NULL)
		return -ENOMEM;
	err = find_resolve(h, &id);
	if (err) {
		free(id.name);
		return err;
	}
	h->ids[h->id_count] = id;
	return (int)h->id_count++;
}

void find_free(struct ows *h)
{
	for (unsigned i = 0; i < h->id_count; i++)
		free(h->ids[i].name);
	for (unsigned i = 0; i < h->memory_count; i++)
		free(h->memories[i].name);
	free(h->ids);
	free(h->memories);
}
