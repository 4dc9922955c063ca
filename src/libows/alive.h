/* SPDX-License-Identifier: MIT */
/* Whether owsd lives, and whether the image is still the present one. */
#ifndef LIBOWS_ALIVE_H
#define LIBOWS_ALIVE_H

#include <errno.h>

#include "src/libows/handle.h"

/* A name that leads to another segment is looked for no more often. */
#define ORPHAN_LOOK_NS INT64_C(1000000000)

/* From the heartbeat, whatever is known of this now_ns already. */
bool alive_find(struct ows *h, int64_t now_ns);

/* Does owsd live, as far as its heartbeat says? If not, h->orphan is looked at too. */
static inline bool handle_alive(struct ows *h, int64_t now_ns)
{
	return now_ns == h->alive_now ? h->alive : alive_find(h, now_ns);
}

/* 0, or -ESTALE when the image is not the present one any more. */
static inline int handle_state(const struct ows *h)
{
	uint32_t state = __atomic_load_n(&h->map.image->state, __ATOMIC_ACQUIRE);

	return state == OWS_STATE_LIVE && !h->orphan ? 0 : -ESTALE;
}

#endif
