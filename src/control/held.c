/* SPDX-License-Identifier: MIT */
/* Memories that owsd is done with and somebody else still holds: they count as owsd's memory. */
#include <unistd.h>

#include "src/control/grant.h"
#include "src/control/held.h"
#include "src/control/sealed.h"

static void let_go(struct control *c, unsigned i)
{
	close(c->held[i].own);
	c->held[i] = c->held[--c->held_count];
}

static void look(struct control *c)
{
	for (unsigned i = c->held_count; i-- > 0;)
		if (!sealed_is_held(c->held[i].own))
			let_go(c, i);
}

void held_free(struct control *c, uid_t uid, struct control_grant *grant)
{
	const struct control_held held = {grant->own, uid, grant->size};

	if (!grant->memory.base) {
		grant_free(grant);
		return;
	}
	grant->own = -1;
	grant_free(grant);
	if (c->held_count == OWS_GIVERS)
		look(c);
	/* root has no limit that this could count for */
	if (!uid || c->held_count == OWS_GIVERS || !sealed_is_held(held.own))
		close(held.own);
	else
		c->held[c->held_count++] = held;
}

unsigned held_of(struct control *c, uid_t uid, size_t *bytes)
{
	unsigned n = 0;

	look(c);
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
	while (c->held_count)
		let_go(c, 0);
}
