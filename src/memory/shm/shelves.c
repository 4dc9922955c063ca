/* SPDX-License-Identifier: MIT */
/* Finds the shelved alarms of an earlier image, and enters them in the present one. */
#include <string.h>

#include "src/memory/shm/entries.h"
#include "src/memory/shm/reader.h"
#include "src/memory/shm/shelves.h"

/* An earlier image. */
struct earlier {
	const char *base;
	size_t size;
	struct ows_area_entry infos, pool, shelves;
};

static bool inside(const struct earlier *from, uint64_t off, uint64_t count, uint64_t size)
{
	return off % 8 == 0 && count <= from->size && size <= from->size &&
	       off + count * size <= from->size;
}

/* Find the area of this kind; least: the bytes of our entry. */
static bool shelves_find(const struct earlier *from, enum ows_area kind, size_t least,
                         struct ows_area_entry *area)
{
	const struct ows_image_header *h = (const void *)from->base;

	for (uint32_t i = 0; i < h->area_count; i++) {
		memcpy(area, from->base + h->area_off + i * sizeof(*area), sizeof(*area));
		if (area->kind == (uint32_t)kind)
			return area->size >= least && area->count > 0 &&
			       (least == 1 || area->size % 8 == 0) &&
			       inside(from, area->off, area->count, area->size);
	}
	return false;
}

static bool open_earlier(struct earlier *from)
{
	const struct ows_image_header *h = (const void *)from->base;

	return from->size >= sizeof(*h) && h->magic == OWS_IMAGE_MAGIC &&
	       h->major == OWS_LAYOUT_MAJOR &&
	       inside(from, h->area_off, h->area_count, sizeof(struct ows_area_entry)) &&
	       shelves_find(from, OWS_AREA_INFOS, sizeof(struct ows_info_entry), &from->infos) &&
	       shelves_find(from, OWS_AREA_POOL, 1, &from->pool) &&
	       shelves_find(from, OWS_AREA_SHELVES, sizeof(struct ows_shelf_entry),
	                    &from->shelves) &&
	       from->base[from->pool.off + from->pool.count - 1] == '\0';
}

/* The name of a record; NULL: there is no such record. */
static const char *earlier_name(const struct earlier *from, uint32_t record)
{
	const struct ows_info_entry *info;

	if (record >= from->infos.count)
		return NULL;
	info = (const void *)(from->base + from->infos.off + (size_t)record * from->infos.size);
	if (info->name_off < from->pool.off || info->name_off - from->pool.off >= from->pool.count)
		return NULL;
	return from->base + info->name_off;
}

/* The record of this name; 0: none. */
static uint32_t record_of(const struct image *image, const char *name)
{
	uint32_t low = 0, high = image->record_count;

	while (low < high) {
		uint32_t middle = low + (high - low) / 2;
		int order = strcmp(name, image->base + image->names[middle].name_off);

		if (order == 0)
			return image->names[middle].record;
		if (order < 0)
			high = middle;
		else
			low = middle + 1;
	}
	return 0;
}

/* The record that follows one of the image before; by name unless that follows another. 0: none. */
static uint32_t follower(const struct image *image, const struct earlier *from, uint32_t record,
                         const uint32_t *records)
{
	const char *name = earlier_name(from, record);
	uint32_t named = name ? record_of(image, name) : 0;

	if (!name || !records)
		return named;
	if (records[record - 1] != UINT32_MAX)
		return records[record - 1] + 1;
	for (uint32_t i = 0; i + 1 < from->infos.count; i++)
		if (records[i] != UINT32_MAX && records[i] + 1 == named)
			return 0;
	return named;
}

void shelves_carry(struct image *image, const void *before, size_t size, const uint32_t *records)
{
	struct earlier from = {.base = before, .size = size};
	uint32_t entered = 0;

	if (!open_earlier(&from))
		return;
	for (uint32_t i = 0; i < from.shelves.count && entered < OWS_SHELVES; i++) {
		const char *at = from.base + from.shelves.off + (size_t)i * from.shelves.size;
		struct ows_shelf_entry entry;

		if (!reader_entry((const void *)at, &entry, sizeof(entry)) || !entry.record)
			continue;
		entry.record = follower(image, &from, entry.record, records);
		if (entry.record)
			image_shelf(image, entered++, &entry);
	}
}
