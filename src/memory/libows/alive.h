/* SPDX-License-Identifier: MIT */
/* Whether owsd lives, and whether the image is still the present one. */
#pragma once

#include <errno.h>

#include "hal/base/time.h"
#include "src/memory/libows/handle.h"

/* The time between two looks whether there is another image. */
#define ALIVE_LOOK_NS NS_PER_S
/* The least age of a dead heartbeat. */
#define ALIVE_LEAST_NS (2 * NS_PER_S)

/* The greatest age of a living owsd's heartbeat. */
int64_t alive_dead_after(const struct ows_map *map);

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
 * The same, and checks once a second, while the heart stands still, whether there is another image:
 * one system call, if the handle is settled.
 */
int alive_look(struct ows *h, int64_t now_ns);

/* Does the name lead to another image, or does an owsd live that an unsettled handle may take? */
bool alive_is_elsewhere(const struct ows *h);

/*
 * Map the image of the first of the handle's directories with a living owsd; dead_too: of the first
 * with an image. -ENOENT, or what is wrong with the first image that cannot be mapped.
 */
int alive_open(const struct ows *h, bool dead_too, struct ows_map *map, const char **dir);
