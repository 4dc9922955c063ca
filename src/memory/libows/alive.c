/* SPDX-License-Identifier: MIT */
/*
 * Whether owsd lives, by its heartbeat. If it does not, the image may be an orphan: its name was
 * removed while no owsd lived to mark it, and the next owsd makes another.
 */
#include "src/memory/libows/alive.h"
#include "src/memory/libows/map.h"
#include "src/memory/shm/reader.h"

bool alive_find(struct ows *h, int64_t now_ns)
{
	struct ows_sample daemon;

	h->alive_now = now_ns;
	h->alive = reader_sample(map_record(&h->map, 0), &daemon) &&
	           handle_age(now_ns, daemon.measured_ns) <= h->dead_after_ns &&
	           !handle_ahead(h, now_ns, daemon.measured_ns);
	if (h->alive)
		h->orphan = false;
	return h->alive;
}

int alive_look(struct ows *h, int64_t now_ns)
{
	int saved = errno;

	if (!handle_alive(h, now_ns) &&
	    (now_ns < h->looked_ns || handle_age(now_ns, h->looked_ns) >= ALIVE_LOOK_NS)) {
		h->looked_ns = now_ns;
		h->orphan = map_is_elsewhere(&h->map, h->dir, h->instance);
		errno = saved;
	}
	return handle_state(h);
}
