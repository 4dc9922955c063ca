/* SPDX-License-Identifier: MIT */
/*
 * Routing acts here on the facts that events and answers have recorded. It opens and leaves
 * the ways of the groups, moves devices to the groups that serve them, and sends out for those that
 * are nowhere.
 */
#include <assert.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>

#include "src/daemon/engine/due.h"
#include "src/daemon/engine/lane_state.h"
#include "src/daemon/engine/publish.h"
#include "src/daemon/engine/retry.h"
#include "src/daemon/engine/routing/known.h"
#include "src/daemon/engine/routing/move.h"
#include "src/daemon/engine/routing/route.h"
#include "src/daemon/engine/routing/routing.h"
#include "src/ground/text/log.h"

/* --- Groups: which way is open --------------------------------------------------------------- */

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

/* All ways have failed: each has said why, once. From now on one line is for all. */
static void report_round(struct engine *e, struct group *g)
{
	uint64_t times = log_rate(&g->state.rounds, e->time.now_ns);
	char ways[200] = "", others[LOG_OTHERS];
	size_t len = 0;

	g->state.quiet = true;
	for (unsigned w = 0; times && w < g->state.bar.count && len < sizeof(ways); w++)
		len += (size_t)snprintf(ways + len, sizeof(ways) - len, "%s%s", w ? " | " : "",
		                        e->lanes[g->first + w].port->target);
	if (times)
		log_warning(e->log, "%s: nothing found; owsd looks again, each %d s at last%s",
		            ways, (int)(ROUTE_DWELL_MAX_NS / NS_PER_S), log_others(times, others));
}

static void leave_way(struct engine *e, struct group *g, const struct route_step *step)
{
	struct lane *from = &e->lanes[g->first + g->state.bar.open];
	struct lane *to = &e->lanes[g->first + step->way];

	route_bar_took(&g->state.bar, g->ways, step, e->time.now_ns);
	if (g->state.bar.failures < g->state.bar.count)
		g->state.quiet = false;
	else if (g->state.bar.failures % g->state.bar.count == 0)
		report_round(e, g);
	from->state.open = from->state.up = from->state.was_up = false;
	*engine_way(e, from) = (struct route_way){.released = false};
	engine_move_lane(e, from, to, step->why);
	if (from->port->suspend)
		from->port->suspend(from->port->ctx, true);
	engine_publish_target(e, from);
}

static void open_way(struct engine *e, struct group *g, const struct route_step *step)
{
	struct lane *left = &e->lanes[g->first + g->state.bar.leaving];
	struct lane *lane = &e->lanes[g->first + step->way];

	if (!engine_way(e, left)->released) {
		left->counters.not_released++;
		log_warning(e->log, "%s: did not release its hardware; opening %s nevertheless",
		            left->port->target, lane->port->target);
	}
	route_bar_took(&g->state.bar, g->ways, step, e->time.now_ns);
	*engine_way(e, lane) = (struct route_way){.failed = lane->state.stuck,
	                                          .failed_ns = e->time.now_ns};
	lane->state.open = true;
	engine_publish_target(e, lane);
	if (lane->port->suspend)
		lane->port->suspend(lane->port->ctx, false);
	else if (lane->state.reported_up)
		lane_up(lane, "");
}

/* Nothing to let go of but what is lent. */
static void release_idle(struct engine *e, struct group *g)
{
	for (unsigned w = 0; w < g->state.bar.count; w++) {
		struct lane *lane = &e->lanes[g->first + w];

		if (lane->state.open || lane->port->suspend || lane->lent.count ||
		    g->ways[w].released)
			continue;
		g->ways[w].released = true;
		engine_publish_target(e, lane);
	}
}

static void see_group_state(struct engine *e, unsigned group)
{
	struct group *g = &e->groups[group];
	enum route_state state = route_bar_state(&g->state.bar, g->ways, e->time.now_ns);

	if (state == e->states[group].state)
		return;
	e->states[group] = (struct route_group){state, e->time.now_ns};
	engine_presences_check(e);
}

/* What another way did not take over goes bad. */
static void fail_signals(struct engine *e, const struct group *g)
{
	for (unsigned w = 0; w < g->state.bar.count; w++) {
		struct lane *lane = &e->lanes[g->first + w];
		int err = lane->state.fell;

		lane->state.fell = 0;
		if (err)
			lane_down(lane, err);
	}
}

/* Returns when time alone leads to a step. */
static int64_t act_on_group(struct engine *e, unsigned group)
{
	struct group *g = &e->groups[group];
	struct route_step step;

	e->asking -= g->asks;
	g->asks = false;
	/* a step leads to one more at most: to let go, to open */
	for (;;) {
		if (g->state.bar.count > 1)
			release_idle(e, g);
		step = route_bar(&g->state.bar, g->ways, e->time.now_ns);
		if (step.act == ROUTE_STAY)
			break;
		if (step.act == ROUTE_LEAVE)
			leave_way(e, g, &step);
		else
			open_way(e, g, &step);
	}
	see_group_state(e, group);
	fail_signals(e, g);
	return step.again_ns;
}

int64_t engine_route_groups(struct engine *e)
{
	int64_t next = INT64_MAX;

	/* whether a way has let go of what was lent is seen by a look only */
	if (!e->asking && !e->bars && e->time.now_ns < e->group_step_ns)
		return e->group_step_ns;
	for (unsigned i = 0; i < e->group_count; i++)
		next = earlier_ns(next, act_on_group(e, i));
	e->group_step_ns = next;
	return next;
}

/* --- Devices: which group serves them -------------------------------------------------------- */

/* Returns when it is to be looked for next; INT64_MAX: it need not be, or is just now. */
static int64_t look_for_device(struct engine *e, uint32_t index)
{
	struct device *d = &e->table.devices[index];
	int group = route_probe(engine_presences(e, index), e->states, e->group_count, d->group,
	                        d->probed);

	if (d->probing)
		return INT64_MAX;
	if (group < 0) {
		d->probe_ns = 0;
		retry_clear(&d->probe);
		return INT64_MAX;
	}
	/* what was never tried is tried at once */
	if (!d->probe_ns)
		d->probe_ns = e->time.now_ns +
		              (engine_presences(e, index)[group].presence == ROUTE_UNKNOWN
		                       ? 0
		                       : RETRY_FIRST_NS);
	if (e->time.now_ns < d->probe_ns)
		return d->probe_ns;
	d->probing = true;
	d->probed = (unsigned)group;
	due_set_add(&engine_open_lane(e, (unsigned)group)->probes, index);
	return INT64_MAX;
}

static struct route_choice choose_group(struct engine *e, uint32_t index)
{
	const struct device *d = &e->table.devices[index];

	if (index == e->table.device_count)
		return route_path(e->states, e->group_count, d->group, e->time.now_ns);
	return route_device(engine_presences(e, index), e->states, e->group_count, d->group,
	                    d->moved_ns, e->time.now_ns);
}

static void route_one(struct engine *e, uint32_t index)
{
	struct device *d = &e->table.devices[index];
	struct route_choice choice = choose_group(e, index);
	int64_t next;

	if (!d->count)
		return;
	if (choice.group != d->group) {
		struct lane *to = engine_open_lane(e, choice.group);

		d->group = choice.group;
		d->moved_ns = e->time.now_ns;
		engine_move_device(e, d, to, choice.why);
		choice = choose_group(e, index);
	}
	next = choice.again_ns;
	if (index < e->table.device_count)
		next = earlier_ns(next, look_for_device(e, index));
	if (next == INT64_MAX)
		due_wheel_cancel(&e->wheel, engine_device_wait(e, index, WAIT_ROUTE));
	else
		due_wheel_at(&e->wheel, engine_device_wait(e, index, WAIT_ROUTE),
		             engine_period_at(e, next));
}

static bool route_devices(struct engine *e)
{
	bool any = false;
	int64_t device;

	while ((device = due_set_next(&e->routes)) >= 0) {
		due_set_take(&e->routes, (uint32_t)device);
		route_one(e, (uint32_t)device);
		any = true;
	}
	return any;
}

bool engine_route(struct engine *e)
{
	bool any = false;

	for (unsigned i = 0; e->asking && i < e->group_count; i++) {
		if (!e->groups[i].asks)
			continue;
		act_on_group(e, i);
		e->group_step_ns = 0;
		any = true;
	}
	return route_devices(e) || any;
}
