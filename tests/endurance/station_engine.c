/* SPDX-License-Identifier: MIT */
/* The engine's thread: what it asks of buses, what it is told, and its log. */
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>

#include "tests/endurance/memory.h"
#include "tests/endurance/station_private.h"

static int null_fd = -1;

int station_submit(void *ctx, struct bus_req *req)
{
	struct station_bus *b = ctx;

	if (b->orders == bus_depth(b->bus))
		return -EAGAIN;
	for (unsigned i = 0; i < b->lent_count; i++)
		if (b->lent[i] == req)
			world_fails("a request was lent twice", req->path);
	if (b->lent_count == STATION_LENT)
		world_fails("more is lent than the bus takes", req->path);
	b->lent[b->lent_count++] = req;
	b->order[b->orders++] = req;
	b->submitted++;
	station_bus_wake(b);
	return 0;
}

void station_suspend(void *ctx, bool yes)
{
	struct station_bus *b = ctx;

	if ((b->turns_asked & 1) == yes)
		return;
	b->turns_asked++;
	station_bus_wake(b);
}

static void came_back(struct station_bus *b, uint32_t id)
{
	b->answered++;
	for (unsigned i = 0; i < b->lent_count; i++)
		if (b->lent[i]->id == id) {
			b->lent[i] = b->lent[--b->lent_count];
			return;
		}
}

void station_log_begin(void)
{
	if (station.log && null_fd < 0)
		null_fd = open("/dev/null", O_WRONLY | O_CLOEXEC);
}

static void write_log(void)
{
	if (!station.log)
		return;
	if (station.now < station.log_from_ns) {
		log_drain(station.log, null_fd, 0);
		return;
	}
	if (log_drain(station.log, 1, 0))
		dprintf(1, "    at %.3f s\n", (double)(station.now - station.start) / 1e9);
}

static void run_engine(void)
{
	struct generation *g = station.now_serving;

	memory_watch(true);
	station.engine_ns = engine_step(g->engine, station.now);
	engine_published(g->engine);
	memory_watch(false);
	station.engine_steps++;
	write_log();
	if (station.engine_ns <= station.now)
		station.engine_ns = station.now + 1;
	if (station.broken)
		world_fails(station.broken, "");
	station.stepped();
}

bool station_tell_engine(void)
{
	bool any = false;

	while (station.message_count) {
		struct station_message *m =
			&station.message[station.message_head % STATION_MESSAGES];
		struct generation *g = station.now_serving;

		if (m->due_ns > station.now)
			break;
		station.message_head++;
		station.message_count--;
		any = true;
		if (!m->is_event)
			came_back(m->bus, m->answer.id);
		if (m->bus->port == STATION_GONE)
			continue;
		memory_watch(true);
		if (m->is_event)
			engine_event(g->engine, m->bus->port, &m->event, station.now);
		else
			engine_answer(g->engine, m->bus->port, &m->answer, station.now);
		memory_watch(false);
	}
	if (any || station.engine_ns <= station.now)
		run_engine();
	return any;
}

void station_ring(void)
{
	station.engine_ns = station.now;
}
