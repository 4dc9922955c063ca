/* SPDX-License-Identifier: MIT */
/* A bus and its thread: what it may wait for, and what it says. */
#include <errno.h>
#include <string.h>

#include "hal/bus/backends.h"
#include "tests/endurance/station_private.h"

#define ANSWER_NS (100 * 1000)

static void broken(const char *what)
{
	if (!station.broken)
		station.broken = what;
}

static int64_t station_now(void *ctx)
{
	(void)ctx;
	return station.now;
}

static int bus_wait(void *ctx, int fd, short events, int64_t until_ns)
{
	struct station_bus *b = ctx;

	if (b->stopping)
		return -ECANCELED;
	if (until_ns == INT64_MAX)
		broken("a wait without deadline");
	if (fd < 0 && until_ns <= station.now)
		return 0;
	if (fd < 0 && until_ns <= station_until && until_ns < station_next(b)) {
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

/* As hal/bus/worker.c does. */
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

void station_bus_wake(struct station_bus *b)
{
	if (b->sleeps && b->wake_ns > station.now)
		b->wake_ns = station.now;
}

struct station_bus *station_bus_open(const struct config_target *target, bool suspended)
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
	*b = (struct station_bus){.part = part, .fd = -1, .wake_ns = station.now};
	b->env = (struct bus_env){.ctx = b,
	                          .now = station_now,
	                          .wait = bus_wait,
	                          .answer = bus_answers,
	                          .event = bus_tells};
	if (bus_create(target->text, &b->env, &b->bus, why, sizeof(why)))
		world_fails(why, target->text);
	part->bus = b->bus;
	if (part->ops->opened)
		part->ops->opened(part, b->bus);
	b->turns_asked = suspended;
	fiber_begin(&b->fiber, work, b);
	return b;
}

void station_bus_free(struct station_bus *b)
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
	*b = (struct station_bus){.fd = -1};
}

bool station_bus_speaks(const struct station_bus *b)
{
	for (unsigned i = 0; i < station.message_count; i++)
		if (station.message[(station.message_head + i) % STATION_MESSAGES].bus == b)
			return true;
	return false;
}
