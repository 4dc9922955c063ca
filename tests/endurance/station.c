/* SPDX-License-Identifier: MIT */
/* The clock, the threads and what goes between them. */
#include "station.h"

#include "memory.h"

#include "src/engine/table.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define ANSWER_NS   (100 * 1000)
#define IDLE_MOST   200000 /* turns in which no time passes */

struct station station;
static int null_fd = -1;

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
	station.timer[station.timer_count++] = (struct station_timer){ station.now + ns, end, ctx };
}

/* --- Inside a bus ---------------------------------------------------------------------------- */

static void broken(const char *what)
{
	if (!station.broken)
		station.broken = what;
}

/* When anything but this bus has something to do. */
static int64_t next_of_others(const struct station_bus *own)
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

static int64_t bus_now(void *ctx)
{
	(void)ctx;
	return station.now;
}

static int64_t run_until;

static int bus_wait(void *ctx, int fd, short events, int64_t until_ns)
{
	struct station_bus *b = ctx;

	if (b->stopping)
		return -ECANCELED;
	if (until_ns == INT64_MAX)
		broken("a wait without deadline");
	if (fd < 0 && until_ns <= station.now)
		return 0;
	if (fd < 0 && until_ns <= run_until && until_ns < next_of_others(b)) {
		station.now = until_ns;
		return 0;
	}
	b->fd = fd;
	b->events = events;
	b->wake_ns = until_ns;
	b->ready = false;
	if (fd >= 0 && b->part->ops->ready)
		b->wake_ns = station.now; /* the part is asked first */
	do {
		fiber_leave(&b->fiber);
		if (b->stopping)
			return -ECANCELED;
		if (fd >= 0 && b->part->ops->ready) {
			int64_t at = b->part->ops->ready(b->part, fd, events);

			b->ready = at <= station.now;
			b->wake_ns = at < until_ns ? at : until_ns;
		}
	} while (!b->ready && station.now < until_ns);
	b->fd = -1;
	return b->ready;
}

void world_block(int64_t ns)
{
	struct station_bus *b = station.running;
	int64_t until = station.now + ns;

	if (!b)
		return;
	b->in_kernel = true;
	while (station.now < until) {
		b->wake_ns = until;
		fiber_leave(&b->fiber);
	}
	b->in_kernel = false;
}

static struct station_message *add_message(struct station_bus *b)
{
	struct station_message *m;

	if (station.message_count == STATION_MESSAGES) {
		broken("too many messages");
		return NULL;
	}
	m = &station.message[(station.message_head + station.message_count++) % STATION_MESSAGES];
	m->due_ns = station.now + ANSWER_NS;
	m->bus = b;
	station.idle = 0;
	return m;
}

static void bus_answers(void *ctx, const struct bus_answer *answer)
{
	struct station_message *m = add_message(ctx);

	if (!m)
		return;
	m->is_event = false;
	m->answer = *answer;
}

static void bus_tells(void *ctx, const struct bus_event *event)
{
	struct station_message *m = add_message(ctx);

	if (!m)
		return;
	m->is_event = true;
	m->event = *event;
}

/* As hal/worker.c does. */
static void work(void *ctx)
{
	struct station_bus *b = ctx;

	while (!b->stopping) {
		unsigned taken = 0;
		int64_t next;

		while (taken < b->orders && !bus_submit(b->bus, b->order[taken]))
			taken++;
		memmove(b->order, b->order + taken, (b->orders - taken) * sizeof(b->order[0]));
		b->orders -= taken;
		while (b->turns_done != b->turns_asked)
			bus_suspend(b->bus, ++b->turns_done & 1);
		next = bus_step(b->bus, station.now);
		b->sleeps = true;
		b->wake_ns = next;
		if (b->orders && next == INT64_MAX)
			broken("a bus takes less than its depth");
		if (!b->stopping)
			fiber_leave(&b->fiber);
		b->sleeps = false;
	}
	b->wake_ns = INT64_MAX;
}

static void wake(struct station_bus *b)
{
	if (b->sleeps && b->wake_ns > station.now)
		b->wake_ns = station.now;
}

/* --- The engine's thread --------------------------------------------------------------------- */

static int submit(void *ctx, struct bus_req *req)
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
	wake(b);
	return 0;
}

static void suspend(void *ctx, bool yes)
{
	struct station_bus *b = ctx;

	if ((b->turns_asked & 1) == yes)
		return;
	b->turns_asked++;
	wake(b);
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
	commands_mend(&g->commands, false);
	station.engine_steps++;
	write_log();
	if (station.engine_ns <= station.now)
		station.engine_ns = station.now + 1;
	if (station.broken)
		world_fails(station.broken, "");
	station.stepped();
}

static bool tell_engine(void)
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

/* --- The clock ------------------------------------------------------------------------------- */

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

static void free_generation(struct generation *g)
{
	engine_destroy(g->engine);
	commands_forget(&g->commands);
	config_free(g->config);
	free(g->image_memory);
	free(g->command_memory);
	free(g);
}

static void free_bus(struct station_bus *b)
{
	bus_destroy(b->bus);
	fiber_end(&b->fiber);
	if (b->part->bus == b->bus)
		b->part->bus = NULL;
	/* what it told on its way is of no interest */
	for (unsigned i = 0; i < station.message_count; i++) {
		struct station_message *m =
			&station.message[(station.message_head + i) % STATION_MESSAGES];

		if (m->bus == b)
			world_fails("a bus that has ended still speaks", b->part->ops->name);
	}
	*b = (struct station_bus){ .fd = -1 };
}

static bool still_speaks(const struct station_bus *b)
{
	for (unsigned i = 0; i < station.message_count; i++)
		if (station.message[(station.message_head + i) % STATION_MESSAGES].bus == b)
			return true;
	return false;
}

/* Of the generations that were replaced, those whose buses have ended. */
static void leave(void)
{
	for (unsigned i = 0; i < station.leaving_count;) {
		struct generation *g = station.leaving[i];
		bool ended = true;

		for (unsigned k = 0; k < g->ending_count; k++)
			ended &= g->ending[k]->fiber.ended && !still_speaks(g->ending[k]);
		if (!ended) {
			i++;
			continue;
		}
		for (unsigned k = 0; k < g->ending_count; k++)
			free_bus(g->ending[k]);
		memory_watch(true);
		engine_abandon(g->engine);
		memory_watch(false);
		free_generation(g);
		station.leaving[i] = station.leaving[--station.leaving_count];
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

		run_until = until_ns;
		end_timers();
		run_parts();
		tell_engine();
		run_buses();
		if (station.leaving_count)
			leave();
		next = next_of_others(NULL);
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

/* --- Generations ----------------------------------------------------------------------------- */

static void say(void *ctx, bool is_error, const char *message)
{
	(void)ctx;
	if (is_error)
		world_fails("its configuration was refused", message);
}

static void *aligned(size_t size)
{
	size_t room = (size + 63) / 64 * 64;
	void *memory = aligned_alloc(64, room);

	if (!memory)
		world_fails("no memory", "");
	memset(memory, 0, room);
	return memory;
}

static void make_memory(struct generation *g)
{
	struct config *c = g->config;
	const char *targets[STATION_PARTS];
	uint32_t groups[STATION_PARTS];
	struct image_signal *rows = calloc(c->item_count, sizeof(*rows));
	struct command_signal *names = calloc(c->item_count, sizeof(*names));
	struct image_counter *counters =
		calloc(engine_counter_count(c->target_count), sizeof(*counters));
	struct image_plan plan = { .signals = rows, .signal_count = c->item_count,
		                   .targets = targets, .target_count = c->target_count,
		                   .groups = groups, .counters = counters,
		                   .counter_count = engine_counter_count(c->target_count),
		                   .generation = (uint32_t)station.reloads + 1, .start_id = 7,
		                   .pid = 1, .start_ns = station.start, .period_ns = c->period_ns };
	struct command_plan command_plan = { .signals = names, .signal_count = c->item_count,
		                             .text_cap = TABLE_TEXT_CAP,
		                             .generation = (uint32_t)station.reloads + 1,
		                             .start_id = 7, .pid = 1 };

	if (!rows || !names || !counters)
		world_fails("no memory", "");
	for (unsigned i = 0; i < c->item_count; i++) {
		signal_table_image(&c->items[i], &rows[i]);
		names[i] = (struct command_signal){ c->items[i].name, c->items[i].path,
			                            (uint8_t)c->items[i].type };
	}
	for (unsigned i = 0; i < c->target_count; i++) {
		targets[i] = c->targets[i].text;
		groups[i] = c->targets[i].group;
	}
	engine_counter_plan(c->target_count, counters);
	g->image_memory = aligned(image_size(&plan));
	g->command_memory = aligned(commands_size(&command_plan));
	image_build(&plan, g->image_memory, &g->image);
	if (commands_build(&command_plan, g->command_memory, &g->commands))
		world_fails("no memory", "");
	free(rows);
	free(names);
	free(counters);
}

static struct station_bus *make_bus(const struct config_target *target, bool suspended)
{
	struct station_bus *b = station.bus;
	struct part *part = station.part;
	char why[200] = "";

	while (b < station.bus + STATION_BUSES && b->part)
		b++;
	while (part < station.part + station.part_count && strcmp(part->target, target->text) != 0)
		part++;
	if (b == station.bus + STATION_BUSES || part == station.part + station.part_count)
		world_fails("no such part", target->text);
	*b = (struct station_bus){ .part = part, .fd = -1, .wake_ns = station.now };
	b->env = (struct bus_env){ .ctx = b, .now = bus_now, .wait = bus_wait,
		                   .answer = bus_answers, .event = bus_tells };
	if (bus_create(target->text, &b->env, &b->bus, why, sizeof(why)))
		world_fails(why, target->text);
	part->bus = b->bus;
	if (part->ops->opened)
		part->ops->opened(part, b->bus);
	b->turns_asked = suspended;
	fiber_begin(&b->fiber, work, b);
	return b;
}

/* Those of `before` that go on, the others made anew. */
static void make_ports(struct generation *g, const struct generation *before,
                       const struct adoption *plan)
{
	const struct config *c = g->config;

	g->port_count = c->target_count;
	for (unsigned i = 0; i < c->target_count; i++) {
		bool first = i == 0 || c->targets[i].group != c->targets[i - 1].group;
		struct station_bus *b = before && plan->ports[i] >= 0
		                                ? before->bus[plan->ports[i]]
		                                : make_bus(&c->targets[i], !first);

		g->bus[i] = b;
		g->ports[i] = (struct engine_port){
			.target = c->targets[i].text, .depth = bus_depth(b->bus),
			.searches = b->bus->ops->searches, .submit = submit, .ctx = b,
			.group = c->targets[i].group,
			.suspend = b->bus->ops->suspend ? suspend : NULL,
		};
	}
}

static struct generation *make_generation(const char *rio, const struct generation *before,
                                          struct adoption *plan)
{
	struct generation *g = calloc(1, sizeof(*g));
	struct config_report report = { .line = say };
	struct engine_setup setup;

	if (!g || config_parse("world.rio", rio, strlen(rio), &report, &g->config))
		world_fails("no memory", "");
	if (before && adoption_plan(plan, g->config, before->config))
		world_fails("no memory", "");
	make_memory(g);
	make_ports(g, before, plan);
	setup = (struct engine_setup){ .config = g->config, .ports = g->ports,
		                       .port_count = g->port_count, .image = &g->image,
		                       .commands = &g->commands, .log = station.log,
		                       .start_ns = station.now };
	if (engine_create(&setup, &g->engine))
		world_fails("no memory", "");
	return g;
}

void station_begin(const char *rio)
{
	for (unsigned i = 0; i < STATION_BUSES; i++)
		station.bus[i].fd = -1;
	if (station.log && null_fd < 0)
		null_fd = open("/dev/null", O_WRONLY | O_CLOEXEC);
	station.now_serving = make_generation(rio, NULL, NULL);
	for (unsigned i = 0; i < station.now_serving->port_count; i++)
		station.now_serving->bus[i]->port = i;
	station.engine_ns = station.now;
}

void station_reload(const char *rio)
{
	struct generation *before = station.now_serving, *g;
	struct adoption plan;

	if (station.leaving_count == STATION_LEAVING)
		return;
	g = make_generation(rio, before, &plan);
	memory_watch(true);
	engine_adopt(g->engine, before->engine, &plan, station.now);
	memory_watch(false);
	for (unsigned i = 0; i < before->port_count; i++)
		before->bus[i]->port = STATION_GONE;
	for (unsigned i = 0; i < g->port_count; i++)
		g->bus[i]->port = i;
	for (unsigned i = 0; i < before->port_count; i++) {
		struct station_bus *b = before->bus[i];

		if (b->port != STATION_GONE)
			continue;
		b->stopping = true;
		b->orders = 0;
		if (!b->in_kernel)
			b->wake_ns = station.now;
		before->ending[before->ending_count++] = b;
	}
	station.leaving[station.leaving_count++] = before;
	station.now_serving = g;
	station.reloads++;
	station.engine_ns = station.now;
	adoption_free(&plan);
}

void station_end(void)
{
	struct generation *g = station.now_serving;

	for (unsigned i = 0; i < g->port_count; i++) {
		struct station_bus *b = g->bus[i];

		b->stopping = true;
		b->port = STATION_GONE;
		if (!b->in_kernel)
			b->wake_ns = station.now;
		while (!b->fiber.ended) {
			if (b->wake_ns > station.now)
				station.now = b->wake_ns;
			station.running = b;
			fiber_enter(&b->fiber);
		}
		station.running = NULL;
		station.message_count = 0;
		free_bus(b);
	}
	free_generation(g);
	for (unsigned i = 0; i < station.part_count; i++)
		station.part[i].ops->end(&station.part[i]);
	memset(&station, 0, sizeof(station));
}
