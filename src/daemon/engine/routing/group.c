/* SPDX-License-Identifier: MIT */
/* The groups of a configuration: the ways to each wire, and what is known of them at the start. */
#include <assert.h>
#include <errno.h>
#include <stdlib.h>

#include "src/daemon/engine/routing/group.h"
#include "src/daemon/engine/routing/route.h"
#include "src/daemon/engine/state.h"

int engine_groups_init(struct engine *e, const struct engine_port *ports)
{
	int64_t patience_ns = e->config->timeout_ns + LANE_GRACE_NS;

	e->ways = calloc(e->lane_count, sizeof(*e->ways));
	e->groups = calloc(e->lane_count, sizeof(*e->groups));
	e->states = calloc(e->lane_count, sizeof(*e->states));
	if (!e->ways || !e->groups || !e->states)
		return -ENOMEM;
	for (unsigned i = 0; i < e->lane_count;) {
		unsigned count = 1, group = ports[i].group;

		assert(group == e->group_count);
		while (i + count < e->lane_count && ports[i + count].group == group)
			count++;
		e->groups[group].first = i;
		e->groups[group].ways = &e->ways[i];
		route_bar_init(&e->groups[group].state.bar, count, patience_ns, e->time.start_ns);
		e->states[group] = (struct route_group){.state = ROUTE_OPENING,
		                                        .since_ns = e->time.start_ns};
		e->lanes[i].state.open = true;
		e->bars |= count > 1;
		for (unsigned w = 1; w < count; w++)
			e->ways[i + w].released = true;
		i += count;
		e->group_count++;
	}
	return 0;
}

void engine_groups_free(struct engine *e)
{
	free(e->ways);
	free(e->groups);
	free(e->states);
}

void engine_group_asks(struct lane *lane)
{
	struct group *g = engine_group(lane->engine, lane);

	lane->engine->asking += !g->asks;
	g->asks = true;
}
