/* SPDX-License-Identifier: MIT */
/* A handle of libows: opened, closed, and opened again when owsd has another image. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "hal/base/time.h"
#include "src/memory/libows/alive.h"
#include "src/memory/libows/handle.h"
#include "src/memory/libows/map.h"
#include "src/memory/libows/meet.h"
#include "src/memory/libows/open.h"
#include "src/memory/shm/dir.h"

/* --- Names that a program looks up ----------------------------------------------------------- */

/* Make room for one more element; *array stays valid when there is no memory. */
static int grow_array(void **array, unsigned count, unsigned *room, size_t size)
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
	if (grow_array(&array, h->memory_count, &h->memory_room, sizeof(*h->memories)))
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
	       attribute == ATTR_READ_ONE_SHOT || attribute == ATTR_WRITE_ONE_SHOT ||
	       attribute == ATTR_DRIVER_DGNRESET;
}

static int find_resolve(struct ows *h, struct ows_id *id)
{
	id->record = attribute_lookup(h->instance, id->name, map_find, &h->map, &id->attribute);
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
	if (grow_array(&array, h->id_count, &h->id_room, sizeof(*h->ids)))
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

static void find_free(struct ows *h)
{
	for (unsigned i = 0; i < h->id_count; i++)
		free(h->ids[i].name);
	for (unsigned i = 0; i < h->memory_count; i++)
		free(h->memories[i].name);
	free(h->ids);
	free(h->memories);
}

/* --- The handle ------------------------------------------------------------------------------ */

#define OPEN_NS ALIVE_LEAST_NS         /* the longest wait of ows_open() for owsd's welcome */
#define OPEN_SLICE_NS (50 * NS_PER_MS) /* then it looks whether there is another image */
#define REOPEN_NS (20 * NS_PER_MS)     /* the longest wait of ows_reopen() */

static void take_map(struct ows *h, const struct ows_map *map)
{
	h->map = *map;
	h->alive_now = h->looked_ns = INT64_MIN;
	h->orphan = h->told_stale = false;
	h->dead_after_ns = alive_dead_after(map);
}

/* Become a controller of the image that is there, which may be replaced meanwhile. */
static int open_joined(struct ows *h)
{
	int64_t until_ns = ows_now() + OPEN_NS;
	int err = 0;

	while (!err) {
		int64_t slice_ns = ows_now() + OPEN_SLICE_NS;
		struct ows_map map;

		err = meet(h, &h->map, slice_ns < until_ns ? slice_ns : until_ns);
		if (err != -EAGAIN)
			break;
		if (ows_now() >= until_ns)
			return -ETIMEDOUT;
		if (h->join.connection < 0)
			clock_pause(10 * NS_PER_MS);
		err = map_open(h->dir, h->instance, &map);
		if (!err) {
			map_close(&h->map);
			take_map(h, &map);
		}
	}
	if (!err) {
		h->settled = true;
		meet_take(h);
	}
	return err;
}

/* The first directory with a living owsd, else the first with an image. */
static int map_first_dir(struct ows *h)
{
	struct ows_map map;
	int err = 0;

	h->settled = alive_open(h, false, &map, &h->dir) == 0;
	if (!h->settled)
		err = alive_open(h, true, &map, &h->dir);
	h->settled |= h->dir_count == 1;
	if (!err)
		take_map(h, &map);
	return err;
}

static int open_one(char dirs[DIRS][DIR_PATH], int count, const char *instance, enum ows_mode mode,
                    const char *program, struct ows **handle)
{
	int saved = errno, err;
	struct ows *h;

	if (!segment_name_ok(instance))
		return -EINVAL;
	h = calloc(1, sizeof(*h));
	if (h == NULL)
		return -ENOMEM;
	memcpy(h->instance, instance, strlen(instance) + 1);
	memcpy(h->program, program, strnlen(program, sizeof(h->program) - 1));
	h->mode = mode;
	join_none(&h->join);
	memcpy(h->dirs, dirs, (size_t)count * DIR_PATH);
	h->dir_count = count;
	err = map_first_dir(h);
	if (!err && mode == OWS_CONTROL)
		err = open_joined(h);
	errno = saved;
	if (err)
		ows_close(h);
	else
		*handle = h;
	return err;
}

int ows_open_as(const char *instance, enum ows_mode mode, const char *name, struct ows **handle)
{
	char dirs[DIRS][DIR_PATH];
	int count = dir_list(dirs);

	*handle = NULL;
	return count < 0 ? count
	                 : open_one(dirs, count, instance ? instance : "OWS", mode, name, handle);
}

int ows_open(const char *instance, enum ows_mode mode, struct ows **handle)
{
	return ows_open_as(instance, mode, program_invocation_short_name, handle);
}

int open_in(const char *dir, const char *instance, enum ows_mode mode, const char *name,
            struct ows **handle)
{
	char dirs[DIRS][DIR_PATH];

	*handle = NULL;
	if (strlen(dir) >= DIR_PATH)
		return -EINVAL;
	memcpy(dirs[0], dir, strlen(dir) + 1);
	return open_one(dirs, 1, instance, mode, name, handle);
}

const char *open_dir(const struct ows *h)
{
	return h->dir;
}

void ows_close(struct ows *h)
{
	int saved = errno;

	if (h == NULL)
		return;
	meet_leave(h);
	map_close(&h->map);
	find_free(h);
	free(h->marks);
	free(h);
	errno = saved;
}

/* Map the present image, and get the memory that belongs to it. */
static int open_present(struct ows *h, struct ows_map *map)
{
	const char *before = h->dir;
	int err = 0;

	if (h->settled || alive_open(h, false, map, &h->dir)) {
		h->dir = before;
		err = map_open(h->dir, h->instance, map);
	}
	if (err)
		return err;
	/* A retired image is no better than the one that the handle has */
	if (word_get(&map->image->state) != OWS_STATE_LIVE)
		err = -ENOENT;
	else if (h->mine != NULL)
		err = meet(h, map, ows_now() + REOPEN_NS);
	if (err && err != -EAGAIN && err != -ENOENT && h->mode == OWS_READ) {
		/* owsd refuses it: a reader goes on by the image alone */
		join_end(&h->join);
		give_unmap(&h->next);
		give_unmap(&h->give);
		err = 0;
	}
	if (err) {
		map_close(map);
		h->dir = before;
	}
	return err == -EAGAIN ? -ENOENT : err;
}

int ows_reopen(struct ows *h)
{
	struct ows_map map;
	int saved = errno, err;
	bool restarted;

	if (h->mine != NULL && handle_is_forked(h))
		return -EPERM;
	err = open_present(h, &map);
	errno = saved;
	if (err)
		return err;
	restarted = map.image->start_ns != h->map.image->start_ns;
	map_close(&h->map);
	take_map(h, &map);
	for (unsigned i = 0; restarted && i < h->memory_count; i++)
		h->memories[i].alarms_seen = 0;
	for (unsigned i = 0; i < h->id_count; i++)
		if (find_resolve(h, &h->ids[i]) == -ENOMEM)
			err = -ENOMEM;
	meet_take(h);
	return err;
}
