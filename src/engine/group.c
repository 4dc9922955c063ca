/* SPDX-License-Identifier: MIT */
/* The ways to one wire: of each group one is open, and this is where that changes. */
#include "private.h"

#include <assert.h>
#include <errno.h>
#include <stdlib.h>

int engine_groups_init(struct engine *e, const struct engine_setup *setup)
{
	int64_t patience_ns = e->config->timeout_ns + LANE_GRACE_NS;

	e->ways = calloc(e->lane_count, sizeof(*e->ways));
	e->groups = calloc(e->lane_count, sizeof(*e->groups));
	e->states = calloc(e->lane_count, sizeof(*e->states));
	if (!e->ways || !e->groups || !e->states)
		return -ENOMEM;
	for (unsigned i = 0; i < e->lane_count;) {
		unsigned count = 1, group = setup->ports[i].group;

		assert(group == e->group_count);
		while (i + count < e->lane_count && setup->ports[i + count].group == group)
			count++;
		e->groups[group].first = i;
		e->groups[group].ways = &e->ways[i];
		route_bar_init(&e->groups[group].bar, count, patience_ns, e->start_ns);
		e->states[group] =
			(struct route_group){ .state = ROUTE_OPENING, .since_ns = e->start_ns };
		e->lanes[i].open = true;
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

static void leave(struct engine *e, struct group *g, const struct route_step *step, int64_t now_ns)
{
	struct lane *from = &e->lanes[g->first + g->bar.open];
	struct lane *to = &e->lanes[g->first + step->way];

	route_bar_took(&g->bar, g->ways, step, now_ns);
	if (g->bar.failures <= g->bar.count)
		g->quiet = false;
	else if (g->bar.failures % g->bar.count == 1)
		g->quiet = !log_rate(&g->rounds, now_ns);
	from->open = from->up = from->was_up = false;
	*engine_way(e, from) = (struct route_way){ .released = false };
	engine_move_lane(e, from, to, step->why, now_ns);
	if (from->port->suspend)
		from->port->suspend(from->port->ctx, true);
	engine_publish_target(e, from);
}

static void open_way(struct engine *e, struct group *g, const struct route_step *step,
                     int64_t now_ns)
{
	struct lane *left = &e->lanes[g->first + g->bar.leaving];
	struct lane *lane = &e->lanes[g->first + step->way];

	if (!engine_way(e, left)->released) {
		left->counters.not_released++;
		log_warning(e->log, "%s: has not let go of its hardware: %s is opened all the same",
		            left->port->target, lane->port->target);
	}
	route_bar_took(&g->bar, g->ways, step, now_ns);
	*engine_way(e, lane) = (struct route_way){ .failed = lane->stuck, .failed_ns = now_ns };
	lane->open = true;
	engine_publish_target(e, lane);
	if (lane->port->suspend)
		lane->port->suspend(lane->port->ctx, false);
	else if (lane->said_up)
		lane_up(lane, "", now_ns);
}

/* Nothing to let go of but what is lent. */
static void release_idle(struct engine *e, struct group *g)
{
	for (unsigned w = 0; w < g->bar.count; w++) {
		struct lane *lane = &e->lanes[g->first + w];

		if (lane->open || lane->port->suspend || lane->lent || g->ways[w].released)
			continue;
		g->ways[w].released = true;
		engine_publish_target(e, lane);
	}
}

static void see_state(struct engine *e, unsigned group, int64_t now_ns)
{
	struct group *g = &e->groups[group];
	enum route_state state = route_bar_state(&g->bar, g->ways, now_ns);

	if (state == e->states[group].state)
		return;
	e->states[group] = (struct route_group){ state, now_ns };
	engine_places_check(e);
}

static int64_t turn(struct engine *e, unsigned group, int64_t now_ns)
{
	struct group *g = &e->groups[group];
	struct route_step step;

	/* a step leads to one more at most: to let go, to open */
	for (;;) {
		if (g->bar.count > 1)
			release_idle(e, g);
		step = route_bar(&g->bar, g->ways, now_ns);
		if (step.act == ROUTE_STAY)
			break;
		if (step.act == ROUTE_LEAVE)
			leave(e, g, &step, now_ns);
		else
			open_way(e, g, &step, now_ns);
	}
	see_state(e, group, now_ns);
	return step.again_ns;
}

void engine_group_check(struct engine *e, unsigned group, int64_t now_ns)
{
	turn(e, group, now_ns);
}

int64_t engine_groups_turn(struct engine *e, int64_t now_ns)
{
	int64_t next = INT64_MAX;

	for (unsigned i = 0; i < e->group_count; i++) {
		int64_t again = turn(e, i, now_ns);

		if (again < next)
			next = again;
	}
	return next;
}
