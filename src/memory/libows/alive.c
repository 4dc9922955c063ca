/* SPDX-License-Identifier: MIT */
/*
 * Whether owsd lives, by its heartbeat. If it does not, the image may be an orphan: its name was
 * removed while no owsd lived to mark it, and the next owsd makes another. Of a handle that has met
 * no living owsd it is one, too, as soon as an owsd of that name lives in another directory.
 */
#include "src/memory/libows/alive.h"
#include "src/memory/libows/map.h"
#include "src/memory/shm/reader.h"

int64_t alive_dead_after(const struct ows_map *map)
{
	int64_t period = map->image->period_ns;

	return period > ALIVE_LEAST_NS / 3 && period < INT64_MAX / 3 ? 3 * period : ALIVE_LEAST_NS;
}

static bool beats(const struct ows_map *map, int64_t now_ns, int64_t dead_after_ns)
{
	struct ows_sample daemon;

	return reader_sample(map_record(map, 0), &daemon) &&
	       handle_age(now_ns, daemon.measured_ns) <= dead_after_ns &&
	       handle_age(daemon.measured_ns, now_ns) <= dead_after_ns;
}

bool alive_find(struct ows *h, int64_t now_ns)
{
	h->alive_now = now_ns;
	h->alive = beats(&h->map, now_ns, h->dead_after_ns);
	if (h->alive) {
		h->orphan = false;
		h->settled |= handle_state(h) == 0;
	}
	return h->alive;
}

static bool lives(const struct ows_map *map)
{
	return word_get(&map->image->state) == OWS_STATE_LIVE &&
	       beats(map, ows_now(), alive_dead_after(map));
}

int alive_open(const struct ows *h, bool dead_too, struct ows_map *map, const char **dir)
{
	int why = -ENOENT;

	for (int i = 0; i < h->dir_count; i++) {
		int err = map_open(h->dirs[i], h->instance, map);

		*dir = h->dirs[i];
		if (!err && (dead_too || lives(map)))
			return 0;
		if (!err)
			map_close(map);
		else if (why == -ENOENT)
			why = err;
	}
	return why;
}

bool alive_is_elsewhere(const struct ows *h)
{
	struct ows_map map;
	const char *dir;
	int saved = errno;
	bool elsewhere = map_is_elsewhere(&h->map, h->dir, h->instance);

	if (!elsewhere && !h->settled && alive_open(h, false, &map, &dir) == 0) {
		map_close(&map);
		elsewhere = true;
	}
	errno = saved;
	return elsewhere;
}

int alive_look(struct ows *h, int64_t now_ns)
{
	if (!handle_alive(h, now_ns) &&
	    (now_ns < h->looked_ns || handle_age(now_ns, h->looked_ns) >= ALIVE_LOOK_NS)) {
		h->looked_ns = now_ns;
		h->orphan = alive_is_elsewhere(h);
	}
	return handle_state(h);
}
