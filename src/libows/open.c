/* SPDX-License-Identifier: MIT */
/* A handle of libows: opened, closed, and opened again when owsd has other segments. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "hal/bus/time.h"
#include "src/libows/find.h"
#include "src/libows/handle.h"
#include "src/libows/map.h"
#include "src/shm/word.h"

#define DEAD_LEAST_NS (2 * NS_PER_S)

static void take_map(struct ows *h, const struct ows_map *map)
{
	int64_t period = map->image->period_ns;

	h->map = *map;
	h->alive_now = h->looked_ns = INT64_MIN;
	h->orphan = false;
	h->dead_after_ns = period > DEAD_LEAST_NS / 3 && period < INT64_MAX / 3 ? 3 * period
	                                                                        : DEAD_LEAST_NS;
}

int ows_open(const char *instance, enum ows_mode mode, struct ows **handle)
{
	struct ows_map map;
	struct ows *h;
	int err;

	*handle = NULL;
	if (instance == NULL)
		instance = "OWS";
	if (!segment_name_ok(instance))
		return -EINVAL;
	err = map_open(instance, mode, &map);
	if (err)
		return err;
	h = calloc(1, sizeof(*h));
	if (h == NULL) {
		map_close(&map);
		return -ENOMEM;
	}
	memcpy(h->instance, instance, strlen(instance) + 1);
	h->mode = mode;
	h->client = -1;
	h->pid = (uint32_t)getpid();
	take_map(h, &map);
	*handle = h;
	return 0;
}

/*
 * Give the client's place back. Its commands stay in force, but no longer belong to the place:
 * after a restart of owsd, the beat of the next program in that place would bring them back.
 */
static void leave_client(struct ows *h)
{
	uint32_t pid = h->pid;

	if (h->client < 0 || word_get(&h->map.clients[h->client].pid) != pid)
		return;
	for (uint32_t i = 0; i < h->map.count; i++) {
		uint32_t mine = (uint32_t)h->client + 1;

		__atomic_compare_exchange_n(&h->map.slots[i].client, &mine, 0, false,
		                            __ATOMIC_RELAXED, __ATOMIC_RELAXED);
	}
	__atomic_compare_exchange_n(&h->map.clients[h->client].pid, &pid, 0, false,
	                            __ATOMIC_RELEASE, __ATOMIC_RELAXED);
}

void ows_close(struct ows *h)
{
	if (h == NULL)
		return;
	leave_client(h);
	map_close(&h->map);
	find_free(h);
	free(h);
}

/* Is the map live? A retired one is no better than the map that the handle has. */
static bool is_present(const struct ows_map *map)
{
	if (word_get(&map->image->state) != OWS_STATE_LIVE)
		return false;
	return map->command == NULL || word_get(&map->command->state) == OWS_STATE_LIVE;
}

int ows_reopen(struct ows *h)
{
	struct ows_map map;
	bool restarted;
	int err = map_open(h->instance, h->mode, &map);

	if (err == -EPROTO)
		return h->mode == OWS_CONTROL ? -ENOENT : err;
	if (err)
		return err;
	if (!is_present(&map)) {
		map_close(&map);
		return -ENOENT;
	}
	restarted = map.image->start_ns != h->map.image->start_ns;
	map_close(&h->map);
	take_map(h, &map);
	for (unsigned i = 0; restarted && i < h->memory_count; i++)
		h->memories[i].alarms_seen = 0;
	for (unsigned i = 0; i < h->id_count; i++)
		if (find_resolve(h, &h->ids[i]) == -ENOMEM)
			err = -ENOMEM;
	/*
	 * owsd carries the table of clients over; in a table without our pid we have no place yet
	 */
	if (h->client >= 0 && word_get(&map.clients[h->client].pid) != h->pid)
		h->client = -1;
	/* a new owsd puts our commands in force again when we beat */
	if (h->client >= 0)
		__atomic_fetch_add(&map.clients[h->client].beat, 1, __ATOMIC_RELEASE);
	return err;
}
