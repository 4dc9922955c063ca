/* SPDX-License-Identifier: MIT */
/* What must be true of requests, counters, memory. The engine's inside is looked at here alone. */
#include <string.h>

#include "src/daemon/engine/counters.h"
#include "src/daemon/engine/state.h"
#include "tests/endurance/invariants.h"
#include "tests/endurance/memory.h"

#define LANE_COUNTS (engine_counter_count(1) - engine_counter_count(0))
/* A request has 20 s, and the bus may find out a little later what became of it. */
#define LENT_NS (40 * FIELD_S)

/* A kept connection has two ends here, and may have been closed at first. */
#define DESCRIPTORS_MORE (2 * station.part_count)

static uint64_t own_seen[STATION_SEEN];
static int64_t moves_gone;
static uint64_t reconnects_gone;
static long memory_first;
static unsigned descriptors_first;

static struct engine *engine(void)
{
	return station.now_serving->engine;
}

bool lane_works(uint32_t record)
{
	const struct lane *lane = engine_lane(engine(), &engine()->table.signals[record - 1]);

	return lane->state.open && lane->state.up && !lane->state.stuck;
}

bool record_reads(uint32_t record)
{
	return signal_reads(&engine()->table.signals[record - 1]);
}

/* --- One lane -------------------------------------------------------------------------------- */

static void requests_add_up(const struct lane *lane, const struct station_bus *b)
{
	uint64_t accepted = b->answered - lane->counters.unknown_answers;

	if (lane->counters.requests != b->submitted)
		world_fails("requests are not what was lent", lane->port->target);
	if (lane->counters.requests != accepted + lane->lent.count)
		world_fails("requests are not answers and what is lent", lane->port->target);
	if (lane->lent.count != b->lent_count)
		world_fails("more is lent than the bus has", lane->port->target);
}

static void given_up_adds_up(const struct lane *lane)
{
	uint64_t waiting = 0;

	for (unsigned i = 0; i < lane->depth; i++)
		waiting += lane->lent.slots[i].lent && lane->lent.slots[i].given_up;
	if (lane->counters.given_up != lane->counters.late_answers + waiting)
		world_fails("given up is not late answers and what is still lent",
		            lane->port->target);
}

static void slots_add_up(const struct lane *lane)
{
	unsigned lent = 0, writes = 0;

	for (unsigned i = 0; i < lane->depth; i++) {
		const struct slot *slot = &lane->lent.slots[i];

		lent += slot->lent;
		writes += slot->lent && !slot->given_up && slot->purpose == FOR_WRITE;
	}
	if (lent != lane->lent.count || lane->lent.free_count + lane->lent.count != lane->depth)
		world_fails("a slot is lost", lane->port->target);
	if (writes != lane->lent.writes)
		world_fails("writes in work are not those that are lent", lane->port->target);
}

static void kinds_add_up(const struct lane *lane)
{
	if (lane->counters.reads + lane->counters.writes + lane->counters.probes +
	            lane->counters.alarm_lists >
	    lane->counters.requests)
		world_fails("more has ended well than was asked for", lane->port->target);
}

static void waits_are_bounded(const struct lane *lane)
{
	for (unsigned i = 0; i < lane->depth; i++) {
		const struct slot *slot = &lane->lent.slots[i];

		if (slot->lent && !slot->given_up && lane->port &&
		    slot->begun_ns + LENT_NS < station.now &&
		    lane->engine->time.resumed_ns + LENT_NS < station.now &&
		    slot->req.deadline_ns + LENT_NS < station.now)
			world_fails("a request waits for ever", slot->path);
	}
}

static void nothing_is_lent_for_long(const struct lane *lane)
{
	for (unsigned i = 0; i < lane->depth; i++)
		if (lane->lent.slots[i].lent &&
		    lane->lent.slots[i].begun_ns + LENT_NS < station.now)
			world_fails("a slot has not come back", lane->lent.slots[i].path);
}

/* --- All lanes ------------------------------------------------------------------------------- */

static int64_t moves_of(const struct engine *e)
{
	int64_t n = 0;

	for (unsigned i = 0; i < e->lane_count; i++)
		n += (int64_t)e->lanes[i].counters.moves_in -
		     (int64_t)e->lanes[i].counters.moves_out;
	return n;
}

static uint64_t reconnects_of(const struct engine *e)
{
	uint64_t n = 0;

	for (unsigned i = 0; i < e->lane_count; i++)
		n += e->lanes[i].counters.reconnects;
	return n;
}

static void totals_add_up(const struct engine *e)
{
	if (moves_of(e) + moves_gone != 0)
		world_fails("signals moved in are not those moved out", "");
	if (reconnects_of(e) + reconnects_gone != e->driver.reconnects)
		world_fails("reconnects are not those of the targets", "");
}

static void step_on(uint64_t *seen, uint64_t now, const char *name)
{
	if (now < *seen)
		world_fails("a counter stepped back", name);
	*seen = now;
}

static void counters_go_on(const struct generation *g)
{
	unsigned own = engine_counter_count(0), each = LANE_COUNTS;
	struct image_counter plan[16 + STATION_PARTS * STATION_SEEN];

	engine_counter_plan(g->port_count, plan);
	for (unsigned i = 0; i < own; i++)
		step_on(&own_seen[i], engine_counter(g->engine, i), plan[i].name);
	for (unsigned p = 0; p < g->port_count; p++) {
		const struct bus_counter *counters;
		size_t n;

		for (unsigned i = 0; i < each; i++)
			step_on(&g->bus[p]->seen[i], engine_counter(g->engine, own + p * each + i),
			        plan[own + p * each + i].name);
		counters = bus_counters(g->bus[p]->bus, &n);
		for (size_t i = 0; i < n && i < STATION_SEEN; i++)
			step_on(&g->bus[p]->own_seen[i], bus_counted(&counters[i]),
			        counters[i].name);
	}
}

static void nothing_is_allocated(void)
{
	if (memory_watched())
		world_fails("the engine's thread has allocated", "");
}

void accounts_step(void)
{
	const struct generation *g = station.now_serving;
	const struct engine *e = g->engine;

	for (unsigned i = 0; i < e->lane_count; i++) {
		requests_add_up(&e->lanes[i], g->bus[i]);
		kinds_add_up(&e->lanes[i]);
	}
	nothing_is_allocated();
	totals_add_up(e);
	/* these look at every slot */
	if (station.engine_steps % 16)
		return;
	for (unsigned i = 0; i < e->lane_count; i++) {
		given_up_adds_up(&e->lanes[i]);
		slots_add_up(&e->lanes[i]);
		waits_are_bounded(&e->lanes[i]);
	}
	counters_go_on(g);
}

/* What a target had counted goes with it. */
void accounts_reloaded(void)
{
	const struct engine *e = engine();

	moves_gone = -moves_of(e);
	reconnects_gone = e->driver.reconnects - reconnects_of(e);
}

/* --- All is well ----------------------------------------------------------------------------- */

static void memory_is_flat(void)
{
	long now = memory_blocks();

	if (!memory_first)
		memory_first = now;
	if (now > memory_first)
		world_fails("more blocks of memory are in use than at first", "");
}

/* What the other ends have closed is closed here too. */
static unsigned descriptors(void)
{
	for (unsigned k = 0; k < station.part_count; k++)
		if (station.part[k].ops->run)
			station.part[k].ops->run(&station.part[k]);
	return memory_descriptors();
}

static void descriptors_are_flat(void)
{
	unsigned now = descriptors();

	if (!descriptors_first)
		descriptors_first = now;
	/* one may just be in use */
	for (int i = 0; now > descriptors_first + DESCRIPTORS_MORE && i < 50; i++) {
		station_run(station.now + 370 * FIELD_MS);
		now = descriptors();
	}
	if (now > descriptors_first + DESCRIPTORS_MORE)
		world_fails("more descriptors are open than at first", "");
}

void accounts_well(void)
{
	const struct engine *e = engine();

	for (unsigned i = 0; i < e->lane_count; i++)
		nothing_is_lent_for_long(&e->lanes[i]);
	memory_is_flat();
	descriptors_are_flat();
}

void accounts_begin(void)
{
	memset(own_seen, 0, sizeof(own_seen));
	moves_gone = 0;
	reconnects_gone = 0;
	memory_first = 0;
	descriptors_first = 0;
}
