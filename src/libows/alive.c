/* SPDX-License-Identifier: MIT */
/*
 * Whether owsd lives, by its heartbeat. If it does not, the image may be an orphan: an owsd that
 * was killed after the names of its segments were removed cannot mark them, and the next owsd makes
 * others.
 */
#include <errno.h>

#include "src/libows/alive.h"
#include "src/libows/map.h"
#include "src/shm/reader.h"

/*
 * Does a name lead to another file than the mapped one? Called while owsd's heart stands still.
 * Makes one or two system calls, at most once a second; in between it returns the last answer.
 * Leaves errno alone.
 */
static bool orphan_look(struct ows *h, int64_t now_ns)
{
	int saved = errno;

	if (now_ns >= h->looked_ns && handle_age(now_ns, h->looked_ns) < ORPHAN_LOOK_NS)
		return h->orphan;
	h->looked_ns = now_ns;
	h->orphan = map_is_elsewhere(&h->map, h->instance);
	errno = saved;
	return h->orphan;
}

bool alive_find(struct ows *h, int64_t now_ns)
{
	struct ows_sample daemon;

	h->alive_now = now_ns;
	h->alive = reader_sample(h->map.records, &daemon) &&
	           handle_age(now_ns, daemon.measured_ns) <= h->dead_after_ns &&
	           !handle_ahead(h, now_ns, daemon.measured_ns);
	h->orphan = !h->alive && orphan_look(h, now_ns);
	return h->alive;
}
