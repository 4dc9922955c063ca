/* SPDX-License-Identifier: MIT */
/*
 * Maps the image of an instance and checks it: owner, layout, and that every area lies inside.
 */
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "src/memory/libows/handle.h"
#include "src/memory/libows/map.h"
#include "src/memory/shm/image.h"
#include "src/memory/shm/owner.h"
#include "src/memory/shm/word.h"

static int map_file(const struct shm_dir *dir, const char *instance, void **base, size_t *size,
                    struct ows_file *file)
{
	char name[SEGMENT_FILE];
	struct stat st;
	int fd, err = 0;

	fd = openat(dir->fd, segment_file(instance, "image", name),
	            O_RDONLY | O_NOFOLLOW | O_CLOEXEC | O_NONBLOCK);
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
		*base = mmap(NULL, *size, PROT_READ, MAP_SHARED, fd, 0);
		if (*base == MAP_FAILED)
			err = -errno;
	}
	close(fd);
	return err;
}

/* Does the text end within size bytes? */
static bool text_ends(const char *text, size_t size)
{
	return memchr(text, '\0', size) != NULL;
}

bool map_has_text(const struct ows_map *map, const struct ows_record *record)
{
	const struct map_area *texts = &map->areas[OWS_AREA_TEXTS];
	uint32_t off = record->text_off, cap = record->text_cap;

	return off % 4 == 0 && cap % 4 == 0 && off >= texts->off &&
	       off - texts->off <= texts->count && 2 * cap <= texts->count - (off - texts->off);
}

static const struct ows_name_entry *name_entry(const struct ows_map *map, uint32_t i)
{
	return map_entry(map, OWS_AREA_NAMES, i);
}

static bool entries_right(const struct ows_map *map)
{
	for (uint32_t i = 0; i < map->count; i++)
		if ((map_record(map, i)->text_cap != 0 && !map_has_text(map, map_record(map, i))) ||
		    name_entry(map, i)->record >= map->count)
			return false;
	for (uint32_t i = 0; i < map_count(map, OWS_AREA_TARGETS); i++)
		if (!text_ends(map_target(map, i)->name, sizeof(map_target(map, i)->name)))
			return false;
	for (uint32_t i = 0; i < map_count(map, OWS_AREA_COUNTERS); i++)
		if (!text_ends(map_counter(map, i)->name, sizeof(map_counter(map, i)->name)))
			return false;
	return true;
}

/* The sizes of our entries. A later minor version may append aligned words to one. */
static const uint16_t entry_size[OWS_AREAS] = {
#define X(kind, type, member, count) [OWS_AREA_##kind] = sizeof(type),
	IMAGE_AREAS(X)
#undef X
};

static bool entry_fits(uint32_t kind, uint32_t size)
{
	if (entry_size[kind] == 1)
		return size == 1;
	return size >= entry_size[kind] && size % 8 == 0;
}

/* Find the areas; none of a kind that is not known here, nor one without entries. */
static bool find_areas(struct ows_map *map, const struct ows_image_header *h)
{
	struct ows_area_entry a = {0};

	if (!area_inside(map->image_size, h->area_off, h->area_count, sizeof(a)))
		return false;
	for (uint32_t i = 0; i < h->area_count; i++) {
		words_load(&a, map->base + h->area_off + i * sizeof(a), sizeof(a) / 4);
		if (a.kind == 0 || a.kind >= OWS_AREAS || a.count == 0)
			continue;
		if (map->areas[a.kind].count != 0 || !entry_fits(a.kind, a.size) ||
		    !area_inside(map->image_size, a.off, a.count, a.size))
			return false;
		map->areas[a.kind] = (struct map_area){map->base + a.off, a.off, a.size, a.count};
	}
	return true;
}

/* Are the counts of the areas such that every index which is used as one lies inside? */
static bool counts_right(const struct ows_map *map)
{
	const struct map_area *pool = &map->areas[OWS_AREA_POOL];
	uint32_t origins = map_count(map, OWS_AREA_ORIGINS);
	uint32_t changes = map_count(map, OWS_AREA_CHANGES);

	return map->count != 0 && map_count(map, OWS_AREA_INFOS) == map->count &&
	       map_count(map, OWS_AREA_NAMES) == map->count &&
	       (origins == 0 || origins == map->count) && (changes & (changes - 1)) == 0 &&
	       pool->count != 0 && pool->base[pool->count - 1] == '\0';
}

static int check_image(struct ows_map *map)
{
	/* zeroed for the analyzer of gcc, which does not follow the loads */
	struct ows_image_header h = {0};

	words_load(&h, map->base, sizeof(h) / 4);
	if (h.magic != OWS_IMAGE_MAGIC || h.major != OWS_LAYOUT_MAJOR ||
	    h.size != map->image_size || !find_areas(map, &h))
		return -EPROTO;
	map->count = map_count(map, OWS_AREA_RECORDS);
	return counts_right(map) && entries_right(map) ? 0 : -EPROTO;
}

int map_open(const char *path, const char *instance, struct ows_map *map)
{
	struct shm_dir dir;
	void *base = NULL;
	int err;

	*map = (struct ows_map){0};
	err = dir_open(path, &dir);
	if (err)
		return err;
	err = map_file(&dir, instance, &base, &map->image_size, &map->image_file);
	dir_close(&dir);
	if (err)
		return err;
	map->base = base;
	map->image = base;
	err = check_image(map);
	if (err)
		map_close(map);
	return err;
}

void map_close(struct ows_map *map)
{
	if (map->base != NULL)
		munmap((void *)(uintptr_t)map->base, map->image_size);
	*map = (struct ows_map){0};
}

const char *map_string(const struct ows_map *map, uint32_t off)
{
	const struct map_area *pool = &map->areas[OWS_AREA_POOL];

	/* The pool ends with a NUL, so every offset into the pool is a string */
	return off >= pool->off && off - pool->off < pool->count ? map->base + off : "";
}

const char *map_name(const struct ows_map *map, uint32_t record)
{
	return map_string(map, map_info(map, record)->name_off);
}

int map_find(void *ctx, const char *name, size_t len)
{
	const struct ows_map *map = ctx;
	uint32_t low = 0, high = map->count;

	while (low < high) {
		uint32_t middle = low + (high - low) / 2;
		const char *there = map_string(map, name_entry(map, middle)->name_off);
		int order = strncmp(there, name, len);

		if (order == 0 && there[len] != '\0')
			order = 1;
		if (order == 0) {
			uint32_t record = name_entry(map, middle)->record;

			return record != 0 && record < map->count ? (int)record : -1;
		}
		if (order < 0)
			low = middle + 1;
		else
			high = middle;
	}
	return -1;
}

bool map_is_elsewhere(const struct ows_map *map, const char *dir, const char *instance)
{
	char path[DIR_PATH + SEGMENT_FILE], name[SEGMENT_FILE];
	struct stat st;

	snprintf(path, sizeof(path), "%s/%s", dir, segment_file(instance, "image", name));
	/* False while there is none: the next owsd makes it */
	return lstat(path, &st) == 0 &&
	       (st.st_ino != map->image_file.inode || st.st_dev != map->image_file.device);
}
