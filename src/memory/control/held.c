/* SPDX-License-Identifier: MIT */
/*
 * Memories that owsd is done with: the porter empties them, and they count as their user's until
 * they are empty. Whether a process still has one cannot be known: a descriptor of O_PATH shows
 * nowhere.
 */
#include "src/memory/control/held.h"
#include "hal/base/time.h"
#include "src/memory/control/grant.h"

/* Connections without end do not make owsd look more often. */
#define LOOK_NS (5 * NS_PER_MS)
/* A controller that has just been sent the next memory still reads in the last one. */
#define AFTER_RELOAD_NS (2 * NS_PER_S)
/* A memory that takes longer is locked by a process; then those of its user wait for it. */
#define LOCKED_NS (NS_PER_S / 2)
/* When a memory is emptied again in which a process has written meanwhile. */
#define AGAIN_NS (NS_PER_S / 2)
/* Before them stand those of the seats; PORTER_SLOTS has room for both. */
#define FIRST_SLOT OWS_CONTROLLERS

void held_open(struct control *c)
{
	for (unsigned i = 0; i < CONTROL_HELD_ALL; i++)
		c->held[i].slot = FIRST_SLOT + i;
}

/* Returns porter_give(). */
static int held_give(struct control *c, const struct control_held *held, bool empty)
{
	const struct porter_order order = {.what = empty ? PORTER_EMPTY : 0,
	                                   .count = 1,
	                                   .keep = empty,
	                                   .slot = empty ? held->slot : PORTER_NO_SLOT,
	                                   .fds = {held->own}};

	return porter_give(c->porter, PORTER_MEMORY, &order);
}

static bool user_has_locked(const struct control *c, uid_t uid)
{
	for (unsigned i = 0; i < c->held_count; i++)
		if (c->held[i].uid == uid && c->held[i].asked_ns &&
		    c->now_ns - c->held[i].asked_ns > LOCKED_NS)
			return true;
	return false;
}

static void empty_memory(struct control *c, struct control_held *held)
{
	if (held->asked_ns || c->now_ns < held->until_ns || user_has_locked(c, held->uid))
		return;
	if (held_give(c, held, true) == 0)
		held->asked_ns = c->now_ns;
}

/* Each slot stays with one memory at most. */
static void remove_memory(struct control *c, struct control_held *held)
{
	uint32_t slot = held->slot;

	*held = c->held[--c->held_count];
	c->held[c->held_count].slot = slot;
}

void held_look(struct control *c)
{
	if (c->now_ns < c->held_ns)
		return;
	c->held_ns = c->now_ns + LOOK_NS;
	for (unsigned i = c->held_count; i-- > 0;) {
		struct control_held *held = &c->held[i];

		empty_memory(c, held);
		if (!held->asked_ns || !porter_carried(c->porter, held->slot))
			continue;
		if (!grant_is_empty(held->own)) {
			held->asked_ns = 0;
			held->until_ns = c->now_ns + AGAIN_NS;
		} else if (held_give(c, held, false) == 0) {
			/* pages that come back count for the user that touches them */
			remove_memory(c, held);
		}
	}
}

bool held_full(const struct control *c)
{
	return c->held_count + 2 * OWS_CONTROLLERS > CONTROL_HELD_ALL;
}

void held_free(struct control *c, uid_t uid, struct control_grant *grant, bool reload)
{
	struct control_held *held = &c->held[c->held_count];

	if (grant->memory.base && c->held_count < CONTROL_HELD_ALL) {
		*held = (struct control_held){.own = grant->own,
		                              .uid = uid,
		                              .size = grant->size,
		                              .until_ns = reload ? c->now_ns + AFTER_RELOAD_NS : 0,
		                              .slot = held->slot};
		grant->own = -1;
		c->held_count++;
	}
	grant_free(grant);
}

unsigned held_of(const struct control *c, uid_t uid, size_t *bytes)
{
	unsigned n = 0;

	*bytes = 0;
	for (unsigned i = 0; i < c->held_count; i++) {
		if (c->held[i].uid != uid)
			continue;
		*bytes += c->held[i].size;
		n++;
	}
	return n;
}

void held_forget(struct control *c)
{
	/* what the porter has no time for ends with this process */
	while (c->held_count)
		held_give(c, &c->held[--c->held_count], false);
}
