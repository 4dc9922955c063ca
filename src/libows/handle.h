/* SPDX-License-Identifier: MIT */
/*
 * The inside of a handle of libows. Not installed.
 *
 * Room src/libows: the library of the consumers. Uses src/shm, src/signal, hal/bus.
 */
#ifndef LIBOWS_HANDLE_H
#define LIBOWS_HANDLE_H

#include <stdbool.h>
#include <sys/types.h>

#include "src/libows/ows.h"
#include "src/shm/layout.h"
#include "src/shm/segment.h"
#include "src/signal/attribute.h"

/* The identity of a segment's file: the name may lead to another file later. */
struct ows_file {
	dev_t device;
	ino_t inode;
};

/*
 * The two segments of one generation. Offsets and counts are read once and checked, so that later
 * damage to the segments leads to no other place.
 */
struct ows_map {
	const struct ows_image_header *image;
	const struct ows_record *records;
	const struct ows_info_entry *infos;
	const struct ows_name_entry *names;
	const struct ows_target_entry *targets;
	const struct ows_counter_entry *counters;
	const struct ows_alarm_entry *alarms;
	/* Entries of a later minor version may be larger: find them by map_record() and the like */
	uint32_t record_size, info_size, target_size, counter_size, alarm_size;
	const char *base;
	size_t image_size;
	struct ows_file image_file;
	uint32_t count, target_count, counter_count, alarm_count;
	uint32_t pool_off, pool_size, text_off, text_size;

	struct ows_command_header *command; /* NULL: OWS_READ */
	struct ows_command_slot *slots;
	struct ows_command_entry *entries;
	struct ows_client *clients;
	uint32_t *dirty;
	uint32_t *acks; /* NULL: the layout is older and has none */
	char *command_base;
	size_t command_size;
	struct ows_file command_file;
	uint32_t text_cap;
};

/* The state that a handle keeps for a signal, over restarts; record 0 has the empty name. */
struct ows_memory {
	char *name;
	uint32_t alarms_seen;
	bool reset_level, shot_level; /* last level set of _DGNRESET and _WriteOneShot */
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
	bool orphan; /* owsd is dead, and a name leads to another file; checked once a second */
	int64_t looked_ns;

	int client; /* index in the table of clients, -1 none */
	uint32_t pid;
	enum ows_mode mode;
	char instance[SEGMENT_NAME_MAX + 1];
};

static inline const struct ows_record *map_record(const struct ows_map *map, uint32_t record)
{
	return (const void *)((const char *)map->records + (size_t)record * map->record_size);
}

static inline const struct ows_info_entry *map_info(const struct ows_map *map, uint32_t record)
{
	return (const void *)((const char *)map->infos + (size_t)record * map->info_size);
}

static inline const struct ows_target_entry *map_target(const struct ows_map *map, uint32_t target)
{
	return (const void *)((const char *)map->targets + (size_t)target * map->target_size);
}

static inline const struct ows_counter_entry *map_counter(const struct ows_map *map,
                                                          uint32_t counter)
{
	return (const void *)((const char *)map->counters + (size_t)counter * map->counter_size);
}

/* The place of alarm n in the ring, which may hold a later alarm by now. */
static inline const struct ows_alarm_entry *map_alarm(const struct ows_map *map, uint32_t number)
{
	return (const void *)((const char *)map->alarms +
	                      (size_t)(number % map->alarm_count) * map->alarm_size);
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

#endif
