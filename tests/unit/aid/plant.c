/* SPDX-License-Identifier: MIT */
/* A plant: engine, native bus, DS2482 driver and simulator on one virtual clock. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "hal/bus/backends.h"
#include "src/config/check/know.h"
#include "src/config/read/load.h"
#include "src/daemon/engine/command/controllers.h"
#include "src/daemon/engine/counters.h"
#include "src/daemon/engine/table.h"
#include "src/ground/signal/value.h"
#include "tests/unit/aid/plant.h"

/* A bus that asks for so many steps without a pause does nothing useful. */
#define IDLE_STEPS_MAX 100000

static void broken(const char *why)
{
	fprintf(stderr, "plant: %s\n", why);
	abort();
}

/* --- The engine's thread --------------------------------------------------------------------- */

static int submit(void *ctx, struct bus_req *req)
{
	struct plant *p = ctx;

	if (p->lent == p->port.depth)
		return -1;
	p->order[p->orders++] = req;
	p->lent++;
	return 0;
}

static void run_engine(struct plant *p)
{
	p->engine_ns = engine_step(p->engine, p->now);
	p->engine_steps++;
	if (p->engine_ns <= p->now)
		p->engine_ns = p->now + 1;
	if (engine_published(p->engine) && p->published)
		p->published(p->ctx);
}

static struct plant_message *next_message(struct plant *p)
{
	return p->message_count ? &p->message[p->message_head % PLANT_MESSAGES] : NULL;
}

/* Give the engine all messages of this moment, then step it. */
static void tell_engine(struct plant *p)
{
	struct plant_message *m;

	while ((m = next_message(p)) != NULL && m->due_ns <= p->now) {
		p->message_head++;
		p->message_count--;
		if (m->is_event) {
			engine_event(p->engine, 0, &m->event, p->now);
			continue;
		}
		p->lent--;
		engine_answer(p->engine, 0, &m->answer, p->now);
	}
	run_engine(p);
}

/*
 * Move the time on to until_ns, and step the engine when it is due; with till_order only to its
 * first request.
 */
static void pass(struct plant *p, int64_t until_ns, bool till_order)
{
	for (;;) {
		const struct plant_message *m = next_message(p);
		int64_t next = m && m->due_ns < p->engine_ns ? m->due_ns : p->engine_ns;

		if (till_order && p->orders)
			return;
		if (next > until_ns)
			break;
		if (next > p->now)
			p->now = next;
		tell_engine(p);
	}
	if (until_ns > p->now)
		p->now = until_ns;
}

/* --- The bus's environment ------------------------------------------------------------------- */

static int64_t plant_bus_now(void *ctx)
{
	return ((struct plant *)ctx)->now;
}

static int bus_wait(void *ctx, int fd, short events, int64_t until_ns)
{
	(void)fd;
	(void)events;
	pass(ctx, until_ns, false);
	return 0;
}

static struct plant_message *add_message(struct plant *p)
{
	struct plant_message *m;

	if (p->message_count == PLANT_MESSAGES)
		broken("too many messages");
	m = &p->message[(p->message_head + p->message_count++) % PLANT_MESSAGES];
	m->due_ns = p->now + p->answer_delay_ns;
	p->idle_steps = 0;
	return m;
}

static void bus_answers(void *ctx, const struct bus_answer *answer)
{
	struct plant_message *m = add_message(ctx);

	m->is_event = false;
	m->answer = *answer;
}

static void bus_tells(void *ctx, const struct bus_event *event)
{
	struct plant_message *m = add_message(ctx);

	m->is_event = true;
	m->event = *event;
}

void plant_run(struct plant *p, int64_t until_ns)
{
	while (p->now < until_ns) {
		int64_t before = p->now, next;

		for (unsigned i = 0; i < p->orders; i++)
			if (bus_submit(p->bus, p->order[i]))
				broken("the bus takes less than its depth");
		p->orders = 0;
		next = bus_step(p->bus, p->now);
		if (next > p->now)
			pass(p, next < until_ns ? next : until_ns, true);
		p->idle_steps = p->now > before ? 0 : p->idle_steps + 1;
		if (p->idle_steps > IDLE_STEPS_MAX)
			broken("the bus spins");
	}
}

/* --- Beginning and end ----------------------------------------------------------------------- */

static void make_bus(struct plant *p, const char *target)
{
	char why[200] = "";

	p->env = (struct bus_env){.ctx = p,
	                          .now = plant_bus_now,
	                          .wait = bus_wait,
	                          .answer = bus_answers,
	                          .event = bus_tells};
	if (bus_create(target, &p->env, &p->bus, why, sizeof(why)))
		broken(why);
}

static void simulate(struct plant *p, const char *scenario)
{
	char file[] = "/tmp/owsd-plant-XXXXXX", target[48];
	int fd = mkstemp(file);
	FILE *f = fd < 0 ? NULL : fdopen(fd, "w");

	if (!f)
		broken("no temporary file");
	fputs(scenario, f);
	fclose(f);
	snprintf(target, sizeof(target), "sim:%s", file);
	make_bus(p, target);
	unlink(file);
	p->net = plant_net(p->bus);
}

static void say(void *ctx, bool is_error, const char *message)
{
	(void)ctx;
	if (is_error)
		broken(message);
}

static void make_memory(struct plant *p)
{
	static const char *const targets[] = {"plant"};
	struct config *c = p->config;
	struct image_signal *rows = calloc(c->item_count, sizeof(*rows));
	uint8_t *types = calloc(c->item_count, 1);
	struct image_counter counters[64];
	struct image_plan plan = {.signals = rows,
	                          .signal_count = c->item_count,
	                          .targets = targets,
	                          .target_count = 1,
	                          .counters = counters,
	                          .counter_count = engine_counter_count(1),
	                          .generation = 1,
	                          .start_id = 7,
	                          .pid = 1,
	                          .start_ns = p->now,
	                          .period_ns = c->period_ns};
	size_t image_room;

	if (!rows || !types || plan.counter_count > 64)
		broken("no memory");
	for (unsigned i = 0; i < c->item_count; i++) {
		signal_table_image(&c->items[i], &rows[i]);
		types[i] = (uint8_t)c->items[i].type;
	}
	engine_counter_plan(1, counters);
	image_room = (image_size(&plan) + 63) / 64 * 64;
	p->image_memory = aligned_alloc(64, image_room);
	if (!p->image_memory)
		broken("no memory");
	memset(p->image_memory, 0, image_room);
	image_build(&plan, p->image_memory, &p->image);
	giving_layout(&p->layout, types, c->item_count);
	giving_make(&p->controller, &p->layout, 1);
	free(rows);
	free(types);
}

static void begin(struct plant *p, const char *rio)
{
	struct config_report report = {.line = say};
	struct engine_setup setup;

	if (config_parse("plant.rio", rio, strlen(rio), &report, &p->config))
		broken("its configuration was refused");
	config_know(p->config);
	make_memory(p);
	p->port = (struct engine_port){.target = "plant",
	                               .depth = bus_depth(p->bus),
	                               .searches = p->bus->ops->searches,
	                               .brief = p->bus->ops->brief,
	                               .submit = submit,
	                               .ctx = p};
	setup = (struct engine_setup){.config = p->config,
	                              .ports = &p->port,
	                              .port_count = 1,
	                              .image = &p->image,
	                              .start_ns = p->now};
	if (engine_create(&setup, &p->engine))
		broken("no memory");
	engine_controller_join(
		p->engine, 0,
		&(struct joining_controller){.memory = p->controller.memory, .who.serial = 1},
		p->now);
	if (p->net)
		sim_net_start(p->net, p->now);
	p->engine_ns = p->now;
}

void plant_begin(struct plant *p, const char *scenario, const char *rio)
{
	memset(p, 0, sizeof(*p));
	p->now = p->start = 1000 * PLANT_S;
	simulate(p, scenario);
	begin(p, rio);
}

void plant_begin_on(struct plant *p, const char *target, const char *rio)
{
	memset(p, 0, sizeof(*p));
	p->now = p->start = 1000 * PLANT_S;
	make_bus(p, target);
	begin(p, rio);
}

void plant_end(struct plant *p)
{
	bus_destroy(p->bus);
	engine_destroy(p->engine);
	giving_free(&p->controller);
	controller_layout_free(&p->layout);
	config_free(p->config);
	free(p->image_memory);
	memset(p, 0, sizeof(*p));
}

/* --- A program's view ------------------------------------------------------------------------ */

struct ows_sample plant_sample(const struct plant *p, unsigned record)
{
	const struct ows_record *r = &p->image.records[record];

	return r->slot[(r->seq >> 1) & 1].sample;
}

double plant_number(const struct plant *p, unsigned record)
{
	return value_number(p->config->items[record - 1].type, plant_sample(p, record).value);
}

void plant_set(struct plant *p, unsigned record, int64_t value)
{
	giving_set(&p->controller, record, value);
	p->engine_ns = p->now;
}

uint64_t plant_count(struct plant *p, const char *name)
{
	size_t n;
	const struct bus_counter *counters = bus_counters(p->bus, &n);

	for (size_t i = 0; i < n; i++)
		if (strcmp(counters[i].name, name) == 0)
			return counters[i].value;
	broken(name);
	return 0;
}

int64_t plant_time(const struct plant *p, int64_t ns)
{
	return ns - p->start;
}
