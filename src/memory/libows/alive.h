/* SPDX-License-Identifier: MIT */
/* Whether owsd lives, and whether the image is still the present one. */
#pragma once

#include <errno.h>

#include "hal/base/time.h"
#include "src/memory/libows/handle.h"

/* The time between two looks whether the name leads to another image. */
#define ALIVE_LOOK_NS NS_PER_S

/* Checks the heartbeat, without the answer that is kept for this now_ns. */
bool alive_find(struct ows *h, int64_t now_ns);

/* Does owsd live, by its heartbeat? No system call. */
static inline bool handle_alive(struct ows *h, int64_t now_ns)
{
	return now_ns == h->alive_now ? h->alive : alive_find(h, now_ns);
}

/* Returns 0, or -ESTALE when the image is no longer the present one. */
static inline int handle_state(const struct ows *h)
{
	uint32_t state = __atomic_load_n(&h->map.image->state, __ATOMIC_ACQUIRE);

	return state == OWS_STATE_LIVE && !h->orphan ? 0 : -ESTALE;
}

/*
 * The same, and checks once a second, while the heart stands still, whether the name leads to
 * another image: at most one system call.
 */
int alive_look(struct ows *h, int64_t now_ns);
