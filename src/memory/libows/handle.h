/* SPDX-License-Identifier: MIT */
/*
 * The inside of a handle of libows. Not installed.
 *
 * Room src/memory/libows: the library of the consumers.
 */
#pragma once

#include <stdbool.h>
#include <sys/types.h>

#include "src/ground/signal/attribute.h"
#include "src/memory/libows/give.h"
#include "src/memory/libows/join.h"
#include "src/memory/shm/dir.h"
#include "src/memory/shm/segment.h"
#include "src/public/ows.h"

/* The identity of a segment's file: the name may lead to another file later. */
struct ows_file {
	dev_t device;
	ino_t inode;
};

/* An area of the image; all zero: the image has none of that kind. */
struct map_area {
	const char *base;
	uint32_t off;  /* of base, from the start of the image */
	uint32_t size; /* of an entry; one of a later minor version may be larger than ours */
	uint32_t count;
};

/*
 * The image of one generation. Offsets and counts are read once and checked, so that later damage
 * to the image leads to no other place.
 */
struct ows_map {
	const struct ows_image_header *image;
	const char *base; /* of the image */
	size_t image_size;
	struct ows_file image_file;
	uint32_t count; /* of records, infos and names */
	struct map_area areas[OWS_AREAS];
};

/* The state that a handle keeps for a signal, over restarts; record 0 has the empty name. */
struct ows_memory {
	char *name;
	uint32_t alarms_seen;
	/* last level set of _DGNRESET, _WriteOneShot and _ReadOneShot */
	bool reset_level, shot_level, read_level;
};

struct ows_id {
	char *name;
	int record; /* -1: not in this image */
	enum attribute attribute;
	unsigned memory;
	int64_t stale_after_ns;
};

struct ows {
	struct ows_map map;
	struct ows_id *ids;
	unsigned id_count, id_room;
	struct ows_memory *memories;
	unsigned memory_count, memory_room;

	/* Does owsd live? Computed once for each now_ns, which is alive_now */
	int64_t alive_now, dead_after_ns;
	bool alive;
	bool told_stale; /* a wait has returned -ESTALE for this image */
	bool orphan;     /* owsd is dead, and there is another image; checked once a second */
	int64_t looked_ns;

	/* The controller: of OWS_CONTROL, and of OWS_READ after ows_fd() */
	struct join join;
	int64_t joined_ns;  /* the start of the owsd that the image was of at that time */
	int64_t awaited_ns; /* when it began to wait for the welcome of a reload; 0: it does not */
	struct give give, next;     /* next: taken, but its image is not mapped yet */
	uint32_t *mine;             /* 1; in a forked child 0. NULL: no controller */
	uint32_t stamp;             /* of the last command */
	uint32_t period_ms;         /* promised; 0: none */
	uint32_t person;            /* as in a slot */
	uint32_t next_person;       /* the slot that is replaced next */
	char person_name[OWS_NAME]; /* "": for itself */
	char program[OWS_NAME];

	uint32_t *marks; /* changes.c: one bit for each record, all 0 between two calls */
	uint32_t mark_words;

	enum ows_mode mode;
	char instance[SEGMENT_NAME_MAX + 1];
	char dirs[DIRS][DIR_PATH]; /* where it looks */
	int dir_count;
	const char *dir; /* the one of them that has the image */
	bool settled;    /* it stays there: it has met a living owsd, or there is no other */
};

/* Does the handle's connection belong to the process that this one was forked from? */
static inline bool handle_is_forked(const struct ows *h)
{
	return h->mine != NULL && word_get(h->mine) == 0;
}

/* The record of a signal's id, 0: it has none. */
static inline uint32_t handle_record(const struct ows *h, int id)
{
	bool known = (unsigned)id < h->id_count && h->ids[id].record > 0;

	return known ? (uint32_t)h->ids[id].record : 0;
}

/* An entry of an area; the caller has compared i with the count. */
static inline const void *map_entry(const struct ows_map *map, enum ows_area kind, uint32_t i)
{
	return map->areas[kind].base + (size_t)i * map->areas[kind].size;
}

static inline uint32_t map_count(const struct ows_map *map, enum ows_area kind)
{
	return map->areas[kind].count;
}

static inline const struct ows_record *map_record(const struct ows_map *map, uint32_t record)
{
	return map_entry(map, OWS_AREA_RECORDS, record);
}

static inline const struct ows_info_entry *map_info(const struct ows_map *map, uint32_t record)
{
	return map_entry(map, OWS_AREA_INFOS, record);
}

static inline const struct ows_target_entry *map_target(const struct ows_map *map, uint32_t target)
{
	return map_entry(map, OWS_AREA_TARGETS, target);
}

static inline const struct ows_counter_entry *map_counter(const struct ows_map *map,
                                                          uint32_t counter)
{
	return map_entry(map, OWS_AREA_COUNTERS, counter);
}

/* The time from then to now; 0 if then is in the future; never overflows, whatever then is. */
static inline int64_t handle_age(int64_t now_ns, int64_t then_ns)
{
	int64_t age;

	if (now_ns <= then_ns)
		return 0;
	return __builtin_sub_overflow(now_ns, then_ns, &age) ? INT64_MAX : age;
}

/*
 * Is then_ns too far in the future to come from a living owsd? It may be a little ahead, since the
 * caller took now_ns before owsd published.
 */
static inline bool handle_ahead(const struct ows *h, int64_t now_ns, int64_t then_ns)
{
	return handle_age(then_ns, now_ns) > h->dead_after_ns;
}
