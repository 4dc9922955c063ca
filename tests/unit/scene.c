/* SPDX-License-Identifier: MIT */
#include "scene.h"

#include "hal/path.h"
#include "src/engine/adopt.h"
#include "src/engine/route.h"
#include "src/signal/value.h"
#include "unity.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static struct config_item *add_item(struct scene *s, const char *name, const char *path,
                                    enum ows_type type)
{
	struct config_item *item = &s->items[s->config.item_count++];

	TEST_ASSERT_LESS_OR_EQUAL(SCENE_ITEMS, s->config.item_count);
	*item = (struct config_item){ .name = name, .path = path, .type = type, .per_factor = 1 };
	item->line = (int)s->config.item_count;
	item->init_text = item->safe_text = "";
	return item;
}

struct config_item *scene_input(struct scene *s, const char *name, const char *path,
                                enum ows_type type)
{
	struct config_item *item = add_item(s, name, path, type);

	item->readable = true;
	return item;
}

struct config_item *scene_output(struct scene *s, const char *name, const char *path,
                                 enum ows_type type)
{
	struct config_item *item = add_item(s, name, path, type);

	item->output = item->writable = true;
	return item;
}

/* What stands under /alarm is the same property; the list of it is one of its own. */
static struct scene_property *find(struct scene *s, unsigned wire, const char *path)
{
	if (strncmp(path, "/alarm/", 7) == 0)
		path += 6;
	for (unsigned i = 0; i < s->property_count; i++)
		if (s->properties[i].wire == wire && strcmp(s->properties[i].path, path) == 0)
			return &s->properties[i];
	return NULL;
}

static bool below(const char *path, const char *device, size_t len)
{
	return strncmp(path, device, len) == 0 && (path[len] == '/' || !path[len]);
}

static bool has_device(struct scene *s, unsigned wire, const char *path)
{
	size_t len = strcspn(path + 1, "/") + 1;

	for (unsigned i = 0; i < s->property_count; i++)
		if (s->properties[i].wire == wire && below(s->properties[i].path, path, len))
			return true;
	return false;
}

void scene_put_on(struct scene *s, unsigned wire, const char *path, const char *text, int err)
{
	struct scene_property *p = find(s, wire, path);

	if (!p) {
		TEST_ASSERT_LESS_THAN(SCENE_ITEMS * 2, s->property_count);
		p = &s->properties[s->property_count++];
		p->path = path;
		p->wire = wire;
	}
	p->err = err;
	snprintf(p->text, sizeof(p->text), "%s", text ? text : "");
}

void scene_put(struct scene *s, const char *path, const char *text, int err)
{
	scene_put_on(s, 0, path, text, err);
}

void scene_plug(struct scene *s, const char *path, unsigned wire)
{
	for (unsigned i = 0; i < s->property_count; i++)
		if (below(s->properties[i].path, path, strlen(path)))
			s->properties[i].wire = wire;
}

void scene_refuse_writes(struct scene *s, const char *path, int err)
{
	find(s, 0, path)->write_err = err;
}

const char *scene_at(struct scene *s, const char *path)
{
	for (unsigned i = 0; i < s->property_count; i++)
		if (strcmp(s->properties[i].path, path) == 0)
			return s->properties[i].text;
	return NULL;
}

struct scene_bus *scene_bus(struct scene *s, const char *name, unsigned wire)
{
	struct scene_bus *bus = &s->bus[s->bus_count];

	TEST_ASSERT_LESS_THAN(SCENE_BUSES, s->bus_count);
	*bus = (struct scene_bus){ .scene = s, .name = name, .wire = wire, .depth = 1 };
	bus->latency_ns = bus->turn_ns = SCENE_MS;
	bus->when_ns = INT64_MAX;
	bus->port = s->bus_count;
	s->targets[s->bus_count].group = wire;
	s->targets[s->bus_count].text = name;
	s->config.target_count = ++s->bus_count;
	return bus;
}

void scene_init(struct scene *s)
{
	*s = (struct scene){ .now_ns = 1000 * SCENE_S };
	s->config = (struct config){
		.file = "scene.rio",
		.targets = s->targets,
		.max_cons_alarms = 5,
		.max_retries = 3,
		.timeout_ns = 20 * SCENE_S,
		.period_ns = 100 * SCENE_MS,
		.alarm_period_ns = 50 * SCENE_MS,
		.items = s->items,
	};
	scene_bus(s, "scene", 0);
}

static void note(struct scene_bus *bus, char what, const char *path, const char *text)
{
	struct scene *s = bus->scene;
	size_t used = strlen(s->trace);
	char number[16] = "";

	if (s->no_trace)
		return;
	if (bus != s->bus)
		snprintf(number, sizeof(number), "%d: ", (int)(bus - s->bus));
	snprintf(s->trace + used, sizeof(s->trace) - used, "%s%c %s%s%s\n", number, what, path,
	         what == 'W' ? "=" : "", text);
}

static int64_t latency_of(const struct scene_bus *bus, const char *path, bool structure)
{
	if (structure)
		return 0;
	return bus->slow && strcmp(path, bus->slow) == 0 ? bus->slow_ns : bus->latency_ns;
}

static int submit(void *ctx, struct bus_req *req)
{
	struct scene_bus *bus = ctx;
	struct scene *s = bus->scene;
	bool structure = strncmp(req->path, "/structure/", 11) == 0;
	char text[128] = "";
	unsigned values = 0;

	TEST_ASSERT_FALSE_MESSAGE(bus->holds && (bus->released || bus->asked),
	                          "asked though it was to let go");
	if (bus->refuses || bus->pending_count + bus->swallowed_count == bus->depth)
		return -EAGAIN;
	if (structure) {
		s->structure_reads++;
	} else if (req->op == BUS_DIR) {
		s->lists++;
		bus->lists++;
		if (s->trace_lists)
			note(bus, 'D', req->path, text);
	} else if (req->op == BUS_WRITE) {
		s->writes++;
		bus->writes++;
		snprintf(text, sizeof(text), "%.*s", (int)req->len, (const char *)req->data);
		note(bus, 'W', req->path, text);
	} else if (req->op == BUS_PROBE) {
		bus->probes++;
	} else {
		s->reads++;
		bus->reads++;
		note(bus, req->fresh ? 'r' : 'R', req->path, text);
	}
	if (bus->mute && !structure) {
		bus->swallowed[bus->swallowed_count++] = req;
		return 0;
	}
	bus->pending[bus->pending_count++] =
		(struct scene_pending){ req, s->now_ns + latency_of(bus, req->path, structure) };
	for (unsigned i = 0; i < bus->pending_count; i++)
		values += strncmp(bus->pending[i].req->path, "/structure/", 11) != 0;
	if (values > bus->most_pending)
		bus->most_pending = values;
	return 0;
}

static void suspend(void *ctx, bool yes)
{
	struct scene_bus *bus = ctx;

	bus->asked = true;
	bus->wanted = !yes;
	bus->asked_ns = bus->scene->now_ns;
	TEST_ASSERT_TRUE_MESSAGE(yes || bus->released, "opened and has not let go before");
	bus->when_ns = bus->scene->now_ns + bus->turn_ns;
	for (unsigned i = 0; !yes && i < bus->scene->bus_count; i++) {
		const struct scene_bus *other = &bus->scene->bus[i];

		if (other != bus && other->wire == bus->wire && !other->released)
			TEST_ASSERT_TRUE_MESSAGE(bus->scene->now_ns - other->asked_ns >=
			                                 ROUTE_RELEASE_NS,
			                         "two masters on one wire");
	}
}

static void make_memory(struct scene *s, const struct config *config, struct image *image,
                        struct commands *commands)
{
	static struct image_signal signals[SCENE_ITEMS];
	static struct command_signal names[SCENE_ITEMS];
	static struct image_counter counters[256];
	const char *targets[SCENE_BUSES];
	struct image_plan plan = {
		.signals = signals,
		.signal_count = config->item_count,
		.targets = targets,
		.target_count = config->target_count,
		.counters = counters,
		.counter_count = engine_counter_count(config->target_count),
		.generation = 1,
		.start_id = 7,
		.pid = 1,
		.start_ns = s->now_ns,
		.period_ns = config->period_ns,
	};
	size_t size;

	for (unsigned i = 0; i < config->target_count; i++)
		targets[i] = config->targets[i].text;
	engine_counter_plan(config->target_count, counters);
	for (unsigned i = 0; i < config->item_count; i++) {
		const struct config_item *item = &config->items[i];

		signals[i] = (struct image_signal){
			.name = item->name,
			.path = item->path,
			.type = (uint8_t)item->type,
			.text_cap = item->type == OWS_STRING ? 1024 : 0,
			.per_factor = item->per_factor,
		};
		names[i] = (struct command_signal){ item->name, item->path, (uint8_t)item->type };
	}
	size = image_size(&plan);
	s->image_memory = aligned_alloc(64, (size + 63) / 64 * 64);
	memset(s->image_memory, 0, size);
	image_build(&plan, s->image_memory, image);
	s->command_plan = (struct command_plan){ .signals = names,
		                                 .signal_count = config->item_count,
		                                 .text_cap = 1024,
		                                 .generation = 1,
		                                 .start_id = 7,
		                                 .pid = 1 };
	size = commands_size(&s->command_plan);
	s->command_memory = aligned_alloc(64, (size + 63) / 64 * 64);
	memset(s->command_memory, 0, size);
	TEST_ASSERT_EQUAL_INT(0, commands_build(&s->command_plan, s->command_memory, commands));
}

static struct scene_bus *bus_named(struct scene *s, const char *name)
{
	for (unsigned i = 0; i < s->bus_count; i++)
		if (strcmp(s->bus[i].name, name) == 0)
			return &s->bus[i];
	TEST_FAIL_MESSAGE("no bus of that name");
	return NULL;
}

static struct engine *make_engine(struct scene *s, const struct config *config,
                                  struct engine_port *ports, struct image *image,
                                  struct commands *commands)
{
	struct engine_setup setup = {
		.config = config,
		.ports = ports,
		.port_count = config->target_count,
		.image = image,
		.commands = commands,
		.log = s->log,
		.guests = s->guests,
		.start_ns = s->now_ns,
	};
	struct engine *engine;

	make_memory(s, config, image, commands);
	for (unsigned i = 0; i < config->target_count; i++) {
		struct scene_bus *bus = bus_named(s, config->targets[i].text);

		ports[i] = (struct engine_port){ .target = bus->name,
			                         .depth = bus->depth,
			                         .searches = bus->searches,
			                         .submit = submit,
			                         .ctx = bus,
			                         .group = config->targets[i].group,
			                         .suspend = bus->holds ? suspend : NULL };
	}
	TEST_ASSERT_EQUAL_INT(0, engine_create(&setup, &engine));
	return engine;
}

void scene_start(struct scene *s)
{
	for (unsigned i = 0; i < s->bus_count; i++) {
		struct scene_bus *bus = &s->bus[i];
		bool first = i == 0 || s->bus[i - 1].wire != bus->wire;

		bus->released = !first;
		if (bus->holds && first) { /* it opens from the start */
			bus->released = bus->asked = bus->wanted = true;
			bus->when_ns = s->now_ns + bus->turn_ns;
		}
	}
	s->engine = make_engine(s, &s->config, s->ports, &s->image, &s->commands);
}

static bool stays(const struct config *config, const struct scene_bus *bus)
{
	for (unsigned i = 0; i < config->target_count; i++)
		if (strcmp(config->targets[i].text, bus->name) == 0)
			return true;
	return false;
}

void scene_reload(struct scene *s, void (*change)(struct config *))
{
	struct scene_part *before = s->part, *part = calloc(1, sizeof(*part));
	void *image_memory = s->image_memory, *command_memory = s->command_memory;
	struct commands commands = s->commands;
	struct engine *engine = s->engine;
	const struct config *config = before ? &before->config : &s->config;
	struct adoption plan;

	part->config = *config;
	part->config.items = part->items;
	part->config.targets = part->targets;
	memcpy(part->items, config->items, sizeof(part->items));
	memcpy(part->targets, config->targets, sizeof(part->targets));
	change(&part->config);
	s->engine = make_engine(s, &part->config, part->ports, &part->image, &part->commands);
	TEST_ASSERT_EQUAL_INT(0, adoption_plan(&plan, &part->config, config));
	engine_adopt(s->engine, engine, &plan, s->now_ns);
	for (unsigned i = 0; i < s->bus_count; i++)
		if (s->bus[i].port < config->target_count && !stays(&part->config, &s->bus[i]))
			s->bus[i].pending_count = 0; /* it was ended */
	for (unsigned i = 0; i < part->config.target_count; i++)
		bus_named(s, part->config.targets[i].text)->port = i;
	engine_destroy(engine);
	adoption_free(&plan);
	commands_forget(&commands);
	free(image_memory);
	free(command_memory);
	free(before);
	s->part = part;
	s->image = part->image;
	s->commands = part->commands;
	memcpy(s->items, part->items, sizeof(s->items));
}

void scene_answer_on(struct scene *s, unsigned bus, uint32_t id, int err, const char *text,
                     struct bus_req *req)
{
	struct bus_answer answer = { .id = id, .err = err, .measured_ns = s->now_ns };

	if (!err && text && req && (req->op == BUS_READ || req->op == BUS_DIR)) {
		answer.len = (uint32_t)strlen(text);
		TEST_ASSERT_LESS_OR_EQUAL(req->len, answer.len);
		memcpy(req->data, text, answer.len);
	}
	engine_answer(s->engine, s->bus[bus].port, &answer, s->now_ns);
}

void scene_answer(struct scene *s, uint32_t id, int err, const char *text, struct bus_req *req)
{
	scene_answer_on(s, 0, id, err, text, req);
}

static void fail_pending(struct scene_bus *bus, int err)
{
	while (bus->pending_count) {
		struct bus_req *req = bus->pending[--bus->pending_count].req;

		scene_answer_on(bus->scene, (unsigned)(bus - bus->scene->bus), req->id, err, NULL,
		                req);
	}
}

static void tell(struct scene *s, unsigned bus, enum bus_news news, int err)
{
	struct bus_event event = { .news = (uint8_t)news, .err = err };

	engine_event(s->engine, s->bus[bus].port, &event, s->now_ns);
}

void scene_down_on(struct scene *s, unsigned bus, int err)
{
	fail_pending(&s->bus[bus], err);
	tell(s, bus, BUS_DOWN, err);
}

void scene_down(struct scene *s, int err)
{
	scene_down_on(s, 0, err);
}

void scene_tell(struct scene *s, unsigned bus, enum bus_news news, const char *path)
{
	struct bus_event event = { .news = (uint8_t)news };
	struct path split;

	TEST_ASSERT_EQUAL_INT(0, path_split(path, strlen(path), &split));
	memcpy(event.rom, split.rom, sizeof(event.rom));
	engine_event(s->engine, s->bus[bus].port, &event, s->now_ns);
}

static void deliver(struct scene_bus *bus, unsigned index)
{
	struct scene *s = bus->scene;
	unsigned number = (unsigned)(bus - s->bus);
	struct bus_req *req = bus->pending[index].req;
	struct scene_property *p =
		find(s, bus->wire, req->op == BUS_DIR ? "/alarm" : req->path);
	int err = req->op == BUS_DIR ? -EOPNOTSUPP : -ENOENT;

	bus->pending[index] = bus->pending[--bus->pending_count];
	if (req->op != BUS_DIR && s->bus_count > 1 && !has_device(s, bus->wire, req->path))
		err = -ENODEV;
	if (req->op == BUS_PROBE)
		err = has_device(s, bus->wire, req->path) ? 0 : -ENODEV;
	if (!p || req->op == BUS_PROBE) {
		scene_answer_on(s, number, req->id, err, NULL, req);
		return;
	}
	if (req->op == BUS_WRITE && p->write_err) {
		scene_answer_on(s, number, req->id, p->write_err, NULL, req);
		return;
	}
	if (s->on_done)
		s->on_done(bus, req);
	if (s->on_read && req->op != BUS_WRITE)
		s->on_read(s, req->path);
	if (req->op == BUS_WRITE && !p->err && s->on_write)
		s->on_write(s, req->path, (const char *)req->data, req->len);
	if (req->op == BUS_WRITE && !p->err)
		snprintf(p->text, sizeof(p->text), "%.*s", (int)req->len, (const char *)req->data);
	scene_answer_on(s, number, req->id, p->err, p->text, req);
}

static bool deliver_structure(struct scene_bus *bus)
{
	for (unsigned i = 0; i < bus->pending_count; i++)
		if (strncmp(bus->pending[i].req->path, "/structure/", 11) == 0) {
			deliver(bus, i);
			return true;
		}
	return false;
}

void scene_up_on(struct scene *s, unsigned bus)
{
	tell(s, bus, BUS_UP, 0);
	do {
		engine_step(s->engine, s->now_ns);
	} while (deliver_structure(&s->bus[bus]));
}

void scene_up(struct scene *s)
{
	scene_up_on(s, 0);
}

void scene_reach(struct scene *s, unsigned number, bool there)
{
	struct scene_bus *bus = &s->bus[number];

	if (bus->there == there)
		return;
	bus->there = there;
	if (!s->engine || bus->mute)
		return;
	if (bus->released) {
		if (there && !bus->asked)
			tell(s, number, BUS_BACK, 0);
	} else if (there) {
		tell(s, number, BUS_UP, 0);
	} else {
		scene_down_on(s, number, -ENOTCONN);
	}
}

/* It has let go, or is open. */
static void turn(struct scene_bus *bus)
{
	struct scene *s = bus->scene;
	unsigned number = (unsigned)(bus - s->bus);

	if (bus->mute) { /* it cannot */
		bus->when_ns = s->now_ns + SCENE_S;
		return;
	}
	bus->when_ns = INT64_MAX;
	bus->asked = false;
	if (!bus->wanted) {
		fail_pending(bus, -ENOTCONN);
		bus->released = true;
		tell(s, number, BUS_RELEASED, 0);
		if (bus->there)
			tell(s, number, BUS_BACK, 0);
		return;
	}
	bus->released = false;
	bus->opened++;
	tell(s, number, bus->there ? BUS_UP : BUS_DOWN, bus->there ? 0 : -ENOENT);
}

/* The soonest of what the buses do next, not after *until; false: nothing. */
static bool next_of_buses(struct scene *s, int64_t *until, struct scene_bus **which, int *pending)
{
	bool any = false;

	for (unsigned b = 0; b < s->bus_count; b++) {
		struct scene_bus *bus = &s->bus[b];

		for (unsigned i = 0; i < bus->pending_count; i++)
			if (bus->pending[i].when_ns <= *until) {
				*until = bus->pending[i].when_ns;
				*which = bus;
				*pending = (int)i;
				any = true;
			}
		if (bus->when_ns <= *until && bus->when_ns != INT64_MAX) {
			*until = bus->when_ns;
			*which = bus;
			*pending = -1;
			any = true;
		}
	}
	return any;
}

void scene_run(struct scene *s, int64_t ns)
{
	int64_t end = s->now_ns + ns;

	for (;;) {
		int64_t next = engine_step(s->engine, s->now_ns);
		struct scene_bus *bus = NULL;
		int pending = -1;
		bool any = next_of_buses(s, &next, &bus, &pending);

		TEST_ASSERT_TRUE_MESSAGE(next > s->now_ns || any, "the engine spins");
		if (next > end)
			break;
		s->now_ns = next;
		if (any && pending >= 0)
			deliver(bus, (unsigned)pending);
		else if (any)
			turn(bus);
	}
	s->now_ns = end;
}

void scene_clear_trace(struct scene *s)
{
	s->trace[0] = '\0';
	s->reads = s->writes = 0;
}

void scene_end(struct scene *s)
{
	engine_destroy(s->engine);
	commands_forget(&s->commands);
	free(s->image_memory);
	free(s->command_memory);
	free(s->part);
	s->part = NULL;
	s->engine = NULL;
}

struct ows_command_slot *scene_slot(struct scene *s, unsigned record)
{
	struct ows_command_header *h = s->command_memory;

	return (struct ows_command_slot *)(void *)((char *)s->command_memory + h->slot_off) +
	       record;
}

void scene_ring(struct scene *s, unsigned record)
{
	struct ows_command_header *h = s->command_memory;
	uint32_t *dirty = (uint32_t *)(void *)((char *)s->command_memory + h->dirty_off);

	dirty[record / 32] |= 1u << (record % 32);
}

void scene_set(struct scene *s, unsigned record, int64_t value)
{
	struct ows_command_slot *slot = scene_slot(s, record);

	slot->value = (uint64_t)value;
	slot->stamp++;
	scene_ring(s, record);
}

void scene_set_text(struct scene *s, unsigned record, const char *text)
{
	struct ows_command_header *h = s->command_memory;
	struct ows_command_entry *entry =
		(struct ows_command_entry *)(void *)((char *)s->command_memory + h->entry_off) +
		record;
	struct ows_command_text *t =
		(struct ows_command_text *)(void *)((char *)s->command_memory + entry->text_off);

	t->len = (uint32_t)strlen(text);
	memcpy(t + 1, text, t->len);
	t->check = ows_check_bytes((const char *)(t + 1), t->len);
	scene_slot(s, record)->stamp++;
	scene_ring(s, record);
}

struct ows_client *scene_client(struct scene *s, unsigned client)
{
	struct ows_command_header *h = s->command_memory;

	return (struct ows_client *)(void *)((char *)s->command_memory + h->client_off) + client;
}

struct ows_sample scene_sample(struct scene *s, unsigned record)
{
	const struct ows_record *r = &s->image.records[record];

	return r->slot[(r->seq >> 1) & 1].sample;
}

struct ows_attrs scene_attrs(struct scene *s, unsigned record)
{
	const struct ows_record *r = &s->image.records[record];

	return r->slot[(r->seq >> 1) & 1].attrs;
}

const char *scene_text(struct scene *s, unsigned record)
{
	static char text[2048];
	const struct ows_record *r = &s->image.records[record];
	uint32_t len = scene_sample(s, record).len;

	TEST_ASSERT_LESS_OR_EQUAL(r->text_cap, len);
	memcpy(text, s->image.base + r->text_off + ((r->seq >> 1) & 1) * r->text_cap, len);
	text[len] = '\0';
	return text;
}

double scene_number(struct scene *s, unsigned record)
{
	return value_number(s->items[record - 1].type, scene_sample(s, record).value);
}

uint64_t scene_counter_of(struct scene *s, unsigned bus, const char *name)
{
	struct image_counter plan[256];

	engine_counter_plan(s->bus_count, plan);
	for (unsigned i = 0; i < engine_counter_count(s->bus_count); i++)
		if (strcmp(plan[i].name, name) == 0 &&
		    (plan[i].target == bus || plan[i].target == UINT32_MAX))
			return engine_counter(s->engine, i);
	TEST_FAIL_MESSAGE("no such counter");
	return 0;
}

uint64_t scene_counter(struct scene *s, const char *name)
{
	return scene_counter_of(s, 0, name);
}

uint32_t scene_target_state(struct scene *s, unsigned bus)
{
	return s->image.targets[bus].state;
}
