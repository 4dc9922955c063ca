/* SPDX-License-Identifier: MIT */
/* The clock, and what goes on at its time. */
#include "tests/endurance/station_private.h"

#define IDLE_MOST 200000 /* turns in which no time passes */

struct station station;
int64_t station_until;

int64_t world_now(void)
{
	return station.now;
}

uint32_t world_random(uint32_t n)
{
	station.random = station.random * 1664525u + 1013904223u;
	return (uint32_t)((uint64_t)(station.random >> 8) * n >> 24);
}

void world_after(int64_t ns, void (*end)(void *ctx), void *ctx)
{
	if (station.timer_count == STATION_TIMERS) {
		end(ctx);
		return;
	}
	station.timer[station.timer_count++] = (struct station_timer){station.now + ns, end, ctx};
}

/* When anything but this bus has something to do. */
int64_t station_next(const struct station_bus *own)
{
	int64_t next = station.engine_ns;

	if (station.message_count) {
		const struct station_message *m =
			&station.message[station.message_head % STATION_MESSAGES];

		next = m->due_ns < next ? m->due_ns : next;
	}
	for (unsigned i = 0; i < STATION_BUSES; i++)
		if (station.bus[i].part && &station.bus[i] != own && station.bus[i].wake_ns < next)
			next = station.bus[i].wake_ns;
	for (unsigned i = 0; i < station.timer_count; i++)
		if (station.timer[i].at_ns < next)
			next = station.timer[i].at_ns;
	for (unsigned i = 0; i < station.part_count; i++) {
		const struct part_ops *ops = station.part[i].ops;
		int64_t at = ops->next ? ops->next(&station.part[i]) : INT64_MAX;

		next = at < next ? at : next;
	}
	return next;
}

static void run_parts(void)
{
	for (unsigned i = 0; i < station.part_count; i++) {
		struct part *part = &station.part[i];

		if (part->ops->next && part->ops->next(part) <= station.now)
			part->ops->run(part);
	}
	for (unsigned i = 0; i < STATION_BUSES; i++) {
		struct station_bus *b = &station.bus[i];

		if (b->part && b->fd >= 0 && b->part->ops->run && b->wake_ns > station.now &&
		    b->part->ops->ready(b->part, b->fd, b->events) <= station.now)
			b->wake_ns = station.now;
	}
}

static void end_timers(void)
{
	for (unsigned i = 0; i < station.timer_count;) {
		struct station_timer t = station.timer[i];

		if (t.at_ns > station.now) {
			i++;
			continue;
		}
		station.timer[i] = station.timer[--station.timer_count];
		t.end(t.ctx);
	}
}

static void run_buses(void)
{
	for (unsigned i = 0; i < STATION_BUSES; i++) {
		struct station_bus *b = &station.bus[i];

		if (!b->part || b->fiber.ended || b->wake_ns > station.now)
			continue;
		b->wake_ns = INT64_MAX;
		station.running = b;
		fiber_enter(&b->fiber);
		station.running = NULL;
	}
}

bool station_settled(void)
{
	return station.leaving_count == 0;
}

static const char *who_is_next(void)
{
	for (unsigned i = 0; i < STATION_BUSES; i++)
		if (station.bus[i].part && station.bus[i].wake_ns <= station.now)
			return station.bus[i].part->target;
	return station.engine_ns <= station.now ? "the engine" : "a part";
}

void station_run(int64_t until_ns)
{
	while (station.now < until_ns) {
		int64_t before = station.now, next;

		station_until = until_ns;
		end_timers();
		run_parts();
		station_tell_engine();
		run_buses();
		if (station.leaving_count)
			station_leave();
		next = station_next(NULL);
		if (next > until_ns)
			next = until_ns;
		if (next > station.now)
			station.now = next;
		station.idle = station.now > before ? 0 : station.idle + 1;
		if (station.idle > IDLE_MOST)
			world_fails("something spins", who_is_next());
	}
}

void station_gap(int64_t ns)
{
	station.now += ns;
}
