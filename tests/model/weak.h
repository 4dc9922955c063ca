/* SPDX-License-Identifier: MIT */
/*
 * A weak memory, as C and C++ promise it to relaxed, release and acquire accesses and to fences:
 * each location keeps all that was ever stored to it, in the order in which it lies there, and a
 * thread may read any of it that is not older than what it knows of. What a thread knows is a view:
 * for each location the oldest message that it may still read. Messages carry the view of who
 * released them. That is RC11 in the form of views (Kang et al., POPL 2017; Dang et al., POPL 2020)
 * without promises: a load is never satisfied by a store that comes later in time.
 *
 * An access that is sequentially consistent counts as release and acquire, which is weaker; only
 * fences are sequentially consistent in full.
 */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#define LOCATIONS 12
#define MESSAGES 20
#define THREADS 4

struct view {
	uint8_t at[LOCATIONS]; /* index of a message */
};

struct message {
	uint64_t value;
	struct view view; /* what its reader gets to know if he acquires */
	bool glued; /* put here by a read-modify-write of the message before: nothing in between */
};

struct location {
	uint8_t count;
	struct message messages[MESSAGES]; /* in modification order */
};

struct knowledge {
	struct view now;      /* bounds what may be read */
	struct view acquired; /* will do so after an acquire fence */
	struct view fenced;   /* as of the last release fence: what relaxed stores carry */
	struct view released[LOCATIONS]; /* as of the thread's own last release store there */
};

struct weak {
	unsigned locations, threads;
	struct location location[LOCATIONS];
	struct knowledge thread[THREADS];
	struct view sc;   /* of the fences that are sequentially consistent */
	struct view lock; /* of the kernel's lock under futex calls */
};

/*
 * In C17 a later store of the same thread goes on with a release sequence, whatever its order; in
 * C++20 only read-modify-writes do. False is the weaker of the two.
 */
extern bool weak_stores_go_on;

void weak_clear(struct weak *m, unsigned threads);
unsigned weak_add(struct weak *m, uint64_t value);

/* Order: __ATOMIC_RELAXED .. __ATOMIC_SEQ_CST. from: the message read; it must be allowed. */
unsigned weak_oldest(const struct weak *m, unsigned thread, unsigned location);
uint64_t weak_load(struct weak *m, unsigned thread, unsigned location, unsigned from, int order);
/* May a store be put behind message from, or a read-modify-write read it? */
bool weak_room(const struct weak *m, unsigned location, unsigned from);
void weak_store(struct weak *m, unsigned thread, unsigned location, unsigned behind, uint64_t value,
                int order);
/* The load half was done by weak_load() of the same message. */
void weak_replace(struct weak *m, unsigned thread, unsigned location, unsigned from, uint64_t value,
                  int order);
void weak_fence(struct weak *m, unsigned thread, int order);
/* Taking and leaving the kernel's lock. */
void weak_lock(struct weak *m, unsigned thread);
void weak_unlock(struct weak *m, unsigned thread);
uint64_t weak_hash(const struct weak *m);

static inline uint64_t mix(uint64_t h, uint64_t value)
{
	h = (h ^ value) * 0x9e3779b97f4a7c15u;
	return h ^ h >> 29;
}
