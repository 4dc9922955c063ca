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

/* NULL: there is no such record. */
static const struct ows_info_entry *earlier_info(const struct earlier *from, uint32_t record)
{
	return record < from->infos.count ? (const void *)(from->base + from->infos.off +
	                                                   (size_t)record * from->infos.size)
	                                  : NULL;
}

/* A text of a record; "" if it is none. */
static const char *earlier_text(const struct earlier *from, uint32_t off)
{
	return off < from->pool.off || off - from->pool.off >= from->pool.count ? ""
	                                                                        : from->base + off;
}

static const char *earlier_identity(const struct earlier *from, const struct ows_info_entry *info)
{
	return earlier_text(from, info->identity_off ? info->identity_off : info->path_off);
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

/* The record of this identity; 0: none. */
static uint32_t record_with(const struct image *image, const char *identity)
{
	for (uint32_t i = 1; i < image->record_count; i++)
		if (!strcmp(identity, image->base + image->infos[i].identity_off))
			return i;
	return 0;
}

/* The record that is the same signal as one of the image before; 0: none. */
static uint32_t same(const struct image *image, const struct earlier *from, uint32_t record,
                     const uint32_t *records)
{
	if (records)
		return records[record - 1] == UINT32_MAX ? 0 : records[record - 1] + 1;
	return record_with(image, earlier_identity(from, earlier_info(from, record)));
}

/* The record that follows one of the image before; by name unless that is another's. 0: none. */
static uint32_t follower(const struct image *image, const struct earlier *from, uint32_t record,
                         const uint32_t *records)
{
	const struct ows_info_entry *info = earlier_info(from, record);
	uint32_t found = info ? same(image, from, record, records) : 0, named;

	if (found || !info)
		return found;
	named = record_of(image, earlier_text(from, info->name_off));
	for (uint32_t i = 1; named && i < from->infos.count; i++)
		if (records ? records[i - 1] + 1 == named
		            : !strcmp(earlier_identity(from, earlier_info(from, i)),
		                      image->base + image->infos[named].identity_off))
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
