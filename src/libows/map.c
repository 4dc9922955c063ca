/* SPDX-License-Identifier: MIT */
/*
 * Maps the segments of an instance and checks them: owner, layout, and that every area lies inside.
 */
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "src/libows/handle.h"
#include "src/libows/map.h"
#include "src/shm/guard.h"
#include "src/shm/owner.h"
#include "src/shm/word.h"

void map_path(const char *instance, const char *kind, char path[MAP_PATH])
{
	snprintf(path, MAP_PATH, "/dev/shm/owsd.%s.%s", instance, kind);
}

static int map_file(const char *instance, const char *kind, bool write, void **base, size_t *size,
                    struct ows_file *file)
{
	char path[MAP_PATH];
	struct stat st;
	int fd, err = 0;

	map_path(instance, kind, path);
	fd = open(path, (write ? O_RDWR : O_RDONLY) | O_NOFOLLOW | O_CLOEXEC | O_NONBLOCK);
	if (fd < 0)
		return errno == ELOOP ? -EPERM : -errno;
	if (fstat(fd, &st) < 0)
		err = -errno;
	else if (!S_ISREG(st.st_mode) || !owner_trusted(st.st_uid))
		err = -EPERM;
	else if (st.st_size < 256 || st.st_size > 0x7fffffff)
		err = -EPROTO;
	if (!err) {
		*size = (size_t)st.st_size;
		*file = (struct ows_file){.device = st.st_dev, .inode = st.st_ino};
		*base = mmap(NULL, *size, PROT_READ | (write ? PROT_WRITE : 0), MAP_SHARED, fd, 0);
		if (*base == MAP_FAILED)
			err = -errno;
	}
	close(fd);
	return err;
}

/* Do count entries of size bytes at off lie inside the segment, in whole words? */
static bool area_inside(size_t segment, uint32_t off, uint32_t count, uint32_t size)
{
	return off % 8 == 0 && off <= segment && (uint64_t)count * size <= segment - off;
}

/* Does the text end within size bytes? */
static bool text_ends(const char *text, size_t size)
{
	return memchr(text, '\0', size) != NULL;
}

bool map_has_text(const struct ows_map *map, const struct ows_record *record)
{
	uint32_t off = record->text_off, cap = record->text_cap;

	return off % 4 == 0 && cap % 4 == 0 && off >= map->text_off &&
	       off - map->text_off <= map->text_size &&
	       2 * cap <= map->text_size - (off - map->text_off);
}

/*
 * Is an entry of `there` bytes one of ours? A later minor version may append aligned words to it.
 */
static bool entry_fits(uint32_t there, size_t ours)
{
	return there >= ours && there % 8 == 0;
}

static bool entries_right(const struct ows_map *map)
{
	for (uint32_t i = 0; i < map->count; i++)
		if ((map_record(map, i)->text_cap != 0 && !map_has_text(map, map_record(map, i))) ||
		    map->names[i].record >= map->count)
			return false;
	for (uint32_t i = 0; i < map->target_count; i++)
		if (!text_ends(map_target(map, i)->name, sizeof(map->targets->name)))
			return false;
	for (uint32_t i = 0; i < map->counter_count; i++)
		if (!text_ends(map_counter(map, i)->name, sizeof(map->counters->name)))
			return false;
	return true;
}

static int check_image(struct ows_map *map)
{
	/* zeroed for the analyzer of gcc, which does not follow the loads */
	struct ows_image_header h = {0};
	size_t size = map->image_size;

	words_load(&h, map->base, sizeof(h) / 4);
	if (h.magic != OWS_IMAGE_MAGIC || h.major != OWS_LAYOUT_MAJOR || h.size != size ||
	    !entry_fits(h.record_size, sizeof(struct ows_record)) ||
	    !entry_fits(h.info_size, sizeof(struct ows_info_entry)) ||
	    !entry_fits(h.target_size, sizeof(struct ows_target_entry)) ||
	    !entry_fits(h.counter_size, sizeof(struct ows_counter_entry)) || h.record_count == 0)
		return -EPROTO;
	if (!area_inside(size, h.record_off, h.record_count, h.record_size) ||
	    !area_inside(size, h.info_off, h.record_count, h.info_size) ||
	    !area_inside(size, h.name_off, h.record_count, sizeof(struct ows_name_entry)) ||
	    !area_inside(size, h.target_off, h.target_count, h.target_size) ||
	    !area_inside(size, h.counter_off, h.counter_count, h.counter_size) ||
	    !area_inside(size, h.alarm_off, h.alarm_count, h.alarm_size) ||
	    (h.alarm_count != 0 && !entry_fits(h.alarm_size, sizeof(struct ows_alarm_entry))) ||
	    !area_inside(size, h.text_off, h.text_size, 1) ||
	    !area_inside(size, h.pool_off, h.pool_size, 1) || h.pool_size == 0 ||
	    map->base[h.pool_off + h.pool_size - 1] != '\0')
		return -EPROTO;
	map->records = (const void *)(map->base + h.record_off);
	map->infos = (const void *)(map->base + h.info_off);
	map->names = (const void *)(map->base + h.name_off);
	map->targets = (const void *)(map->base + h.target_off);
	map->counters = (const void *)(map->base + h.counter_off);
	map->alarms = (const void *)(map->base + h.alarm_off);
	map->record_size = h.record_size;
	map->info_size = h.info_size;
	map->target_size = h.target_size;
	map->counter_size = h.counter_size;
	map->alarm_size = h.alarm_size;
	map->count = h.record_count;
	map->target_count = h.target_count;
	map->counter_count = h.counter_count;
	map->alarm_count = h.alarm_count;
	map->pool_off = h.pool_off;
	map->pool_size = h.pool_size;
	map->text_off = h.text_off;
	map->text_size = h.text_size;
	return entries_right(map) ? 0 : -EPROTO;
}

/* All of the group may write this segment: read every number once and then check it. */
static int check_command(struct ows_map *map)
{
	struct ows_command_header h;
	size_t size = map->command_size;

	words_load(&h, map->command_base, sizeof(h) / 4);
	if (h.magic != OWS_COMMAND_MAGIC || h.major != OWS_LAYOUT_MAJOR || h.size != size ||
	    h.slot_size != sizeof(struct ows_command_slot) ||
	    h.entry_size != sizeof(struct ows_command_entry) ||
	    h.client_size != sizeof(struct ows_client))
		return -EPROTO;
	/*
	 * The segments are of two generations: owsd is putting the new ones in place at the moment
	 */
	if (h.generation != map->image->generation || h.start_id != map->image->start_id)
		return -ENOENT;
	if (h.slot_count != map->count || h.dirty_words != (map->count + 31) / 32 ||
	    !area_inside(size, h.slot_off, h.slot_count, h.slot_size) ||
	    !area_inside(size, h.entry_off, h.slot_count, h.entry_size) ||
	    !area_inside(size, h.dirty_off, h.dirty_words, 4) ||
	    !area_inside(size, h.client_off, OWS_CLIENTS, h.client_size) ||
	    !area_inside(size, h.ack_off, h.slot_count, 4) || h.text_cap > 0xffff)
		return -EPROTO;
	map->command = (void *)map->command_base;
	map->slots = (void *)(map->command_base + h.slot_off);
	map->entries = (void *)(map->command_base + h.entry_off);
	map->dirty = (void *)(map->command_base + h.dirty_off);
	map->clients = (void *)(map->command_base + h.client_off);
	if (h.ack_off != 0)
		map->acks = (void *)(map->command_base + h.ack_off);
	map->text_cap = h.text_cap;
	return 0;
}

int map_open(const char *instance, enum ows_mode mode, struct ows_map *map)
{
	void *base;
	int err;

	*map = (struct ows_map){0};
	err = map_file(instance, "image", false, &base, &map->image_size, &map->image_file);
	if (err)
		return err;
	/* NOLINTNEXTLINE(clang-analyzer-core.uninitialized.Assign): errno is not 0 then */
	map->base = base;
	map->image = base;
	err = check_image(map);
	if (!err && mode == OWS_CONTROL) {
		err = map_file(instance, "command", true, &base, &map->command_size,
		               &map->command_file);
		if (!err) {
			map->command_base = base;
			/* Without a guard all works too, unless a consumer truncates the file */
			guard_add(base, map->command_size, true);
			err = check_command(map);
		}
	}
	if (err)
		map_close(map);
	return err;
}

void map_close(struct ows_map *map)
{
	if (map->command_base != NULL) {
		guard_remove(map->command_base);
		munmap(map->command_base, map->command_size);
	}
	if (map->base != NULL)
		munmap((void *)(uintptr_t)map->base, map->image_size);
	*map = (struct ows_map){0};
}

const char *map_string(const struct ows_map *map, uint32_t off)
{
	/* The pool ends with a NUL, so every offset into the pool is a string */
	return off >= map->pool_off && off - map->pool_off < map->pool_size ? map->base + off : "";
}

const char *map_name(const struct ows_map *map, uint32_t record)
{
	return map_string(map, map_info(map, record)->name_off);
}

int map_find(const struct ows_map *map, const char *name, size_t len)
{
	uint32_t low = 0, high = map->count;

	while (low < high) {
		uint32_t middle = low + (high - low) / 2;
		const char *there = map_string(map, map->names[middle].name_off);
		int order = strncmp(there, name, len);

		if (order == 0 && there[len] != '\0')
			order = 1;
		if (order == 0) {
			uint32_t record = map->names[middle].record;

			return record != 0 && record < map->count ? (int)record : -1;
		}
		if (order < 0)
			low = middle + 1;
		else
			high = middle;
	}
	return -1;
}

/* Does the name lead to another file? False while there is none: the next owsd makes it. */
static bool leads_elsewhere(const char *instance, const char *kind, const struct ows_file *file)
{
	char path[MAP_PATH];
	struct stat st;

	map_path(instance, kind, path);
	return lstat(path, &st) == 0 && (st.st_ino != file->inode || st.st_dev != file->device);
}

bool map_is_elsewhere(const struct ows_map *map, const char *instance)
{
	return leads_elsewhere(instance, "image", &map->image_file) ||
	       (map->command != NULL && leads_elsewhere(instance, "command", &map->command_file));
}
