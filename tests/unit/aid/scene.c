/* SPDX-License-Identifier: MIT */
/* A scene: an engine on the heap, scripted buses, and a trace of what goes to the buses. */
#include <stdlib.h>
#include <string.h>

#include "unity.h"

#include "src/daemon/engine/counters.h"
#include "src/daemon/engine/reload/adopt.h"
#include "src/daemon/engine/table.h"
#include "src/memory/shm/shelves.h"
#include "tests/unit/aid/scene_private.h"

static struct config_item *add_item(struct scene *s, const char *name, const char *path,
                                    enum ows_type type)
{
	struct config_item *item = &s->items[s->config.item_count++];

	TEST_ASSERT_LESS_OR_EQUAL(SCENE_ITEMS, s->config.item_count);
	*item = (struct config_item){
		.name = name, .path = path, .identity = path, .type = type, .per_factor = 1};
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

struct scene_bus *scene_bus(struct scene *s, const char *name, unsigned wire)
{
	struct scene_bus *bus = &s->bus[s->bus_count];

	TEST_ASSERT_LESS_THAN(SCENE_BUSES, s->bus_count);
	*bus = (struct scene_bus){.scene = s, .name = name, .wire = wire, .depth = 1};
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
	*s = (struct scene){.now_ns = 1000 * SCENE_S, .uid = 1000};
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

static void make_memory(struct scene *s, const struct config *config, struct image *image)
{
	static struct image_signal signals[SCENE_ITEMS];
	static struct force_signal names[SCENE_ITEMS];
	static struct image_counter counters[256];
	static uint32_t devices[SCENE_ITEMS];
	uint8_t types[SCENE_ITEMS];
	const char *targets[SCENE_BUSES];
	struct image_plan plan = {
		.signals = signals,
		.signal_count = config->item_count,
		.targets = targets,
		.target_count = config->target_count,
		.counters = counters,
		.counter_count = engine_counter_count(config->target_count),
		.devices = devices,
		.device_count = (uint32_t)table_image_devices(config, devices),
		.generation = 1,
		.start_id = 7,
		.log_lines = 1, /* so that targets have notes */
		.pid = 1,
		.start_ns = s->now_ns,
		.period_ns = config->period_ns,
	};
	const struct force_plan force = {
		.signals = names, .signal_count = config->item_count, .text_cap = 1024};
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
		names[i] = (struct force_signal){item->name, item->path, (uint8_t)item->type};
		types[i] = (uint8_t)item->type;
	}
	size = image_size(&plan);
	s->image_memory = aligned_alloc(64, (size + 63) / 64 * 64);
	memset(s->image_memory, 0, size);
	image_build(&plan, s->image_memory, image);
	s->force_size = force_size(&force);
	s->force_memory = calloc(1, s->force_size);
	s->force = malloc(sizeof(*s->force));
	force_build(&force, s->force_memory, s->force);
	s->layout = malloc(sizeof(*s->layout));
	giving_layout(s->layout, types, config->item_count);
}

/* What belongs to an engine that was replaced. */
static struct scene_memory {
	void *image, *force_memory;
	size_t force_size;
	struct force *force;
	struct controller_layout *layout;
} take_memory(const struct scene *s)
{
	return (struct scene_memory){s->image_memory, s->force_memory, s->force_size, s->force,
	                             s->layout};
}

static void free_memory(struct scene_memory *m)
{
	free(m->image);
	free(m->force_memory);
	free(m->force);
	if (m->layout)
		controller_layout_free(m->layout);
	free(m->layout);
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
                                  const struct force_left *left)
{
	struct engine_setup setup = {
		.config = config,
		.ports = ports,
		.port_count = config->target_count,
		.image = image,
		.left = left,
		.last = scene_disk(s),
		.log = s->log,
		.guests = s->guests,
		.start_ns = s->now_ns,
	};
	const struct image before = s->image;
	struct engine *engine;

	make_memory(s, config, image);
	setup.force = s->force;
	if (left)
		shelves_carry(image, before.base, before.header->size, NULL);
	for (unsigned i = 0; i < config->target_count; i++) {
		struct scene_bus *bus = bus_named(s, config->targets[i].text);

		ports[i] = (struct engine_port){.target = bus->name,
		                                .depth = bus->depth,
		                                .searches = bus->searches,
		                                .brief = bus->brief,
		                                .submit = scene_submit,
		                                .ctx = bus,
		                                .group = config->targets[i].group,
		                                .suspend = bus->holds ? scene_suspend : NULL};
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
		if (bus->holds && first) { /* the bus opens its hardware from the start */
			bus->released = bus->asked = bus->wanted = true;
			bus->when_ns = s->now_ns + bus->turn_ns;
		}
	}
	s->engine = make_engine(s, &s->config, s->ports, &s->image, NULL);
	scene_join(s, 0, 1);
}

static void start_again(struct scene *s, bool machine)
{
	struct scene_memory before = take_memory(s);
	struct force_left left;

	engine_destroy(s->engine);
	for (unsigned i = 0; i < SCENE_CONTROLLERS; i++)
		giving_free(&s->controllers[i]);
	for (unsigned i = 0; i < s->bus_count; i++)
		s->bus[i].pending_count = 0;
	TEST_ASSERT_EQUAL_INT(0, force_open(before.force_memory, before.force_size, 0, &left));
	s->engine = make_engine(s, &s->config, s->ports, &s->image, machine ? NULL : &left);
	force_close(&left);
	free_memory(&before);
	scene_clear_trace(s);
}

void scene_restart(struct scene *s)
{
	start_again(s, false);
}

void scene_reboot(struct scene *s)
{
	start_again(s, true);
}

static bool stays(const struct config *config, const struct scene_bus *bus)
{
	for (unsigned i = 0; i < config->target_count; i++)
		if (strcmp(config->targets[i].text, bus->name) == 0)
			return true;
	return false;
}

/* Each controller that is connected gets a memory of the new engine. */
static void join_anew(struct scene *s, struct giving *before)
{
	for (unsigned i = 0; i < SCENE_CONTROLLERS; i++) {
		before[i] = s->controllers[i];
		if (!before[i].memory.base)
			continue;
		s->controllers[i].memory.base = NULL;
		if (i != 1 || !s->dropped)
			scene_join_again(s, i);
	}
}

void scene_reload(struct scene *s, void (*change)(struct config *))
{
	struct scene_part *before = s->part, *part = calloc(1, sizeof(*part));
	struct scene_memory memory = take_memory(s);
	struct engine *engine = s->engine;
	const struct config *config = before ? &before->config : &s->config;
	struct giving controllers[SCENE_CONTROLLERS];
	struct adoption plan;

	part->config = *config;
	part->config.items = part->items;
	part->config.targets = part->targets;
	memcpy(part->items, config->items, sizeof(part->items));
	memcpy(part->targets, config->targets, sizeof(part->targets));
	if (change)
		change(&part->config);
	s->engine = make_engine(s, &part->config, part->ports, &part->image, NULL);
	join_anew(s, controllers);
	TEST_ASSERT_EQUAL_INT(0, adoption_plan(&plan, &part->config, config));
	engine_adopt(s->engine, engine, &plan, s->now_ns);
	for (unsigned i = 0; i < SCENE_CONTROLLERS; i++)
		giving_free(&controllers[i]);
	for (unsigned i = 0; i < s->bus_count; i++)
		if (s->bus[i].port < config->target_count && !stays(&part->config, &s->bus[i]))
			s->bus[i].pending_count = 0; /* the reload ended these requests */
	for (unsigned i = 0; i < part->config.target_count; i++)
		bus_named(s, part->config.targets[i].text)->port = i;
	engine_destroy(engine);
	adoption_free(&plan);
	free_memory(&memory);
	free(before);
	s->part = part;
	s->image = part->image;
	memcpy(s->items, part->items, sizeof(s->items));
}

void scene_clear_trace(struct scene *s)
{
	s->trace[0] = '\0';
	s->reads = s->writes = 0;
}

void scene_end(struct scene *s)
{
	struct scene_memory memory = take_memory(s);

	engine_destroy(s->engine);
	for (unsigned i = 0; i < SCENE_CONTROLLERS; i++)
		giving_free(&s->controllers[i]);
	free_memory(&memory);
	free(s->part);
	s->part = NULL;
	s->engine = NULL;
	s->layout = NULL;
	s->image_memory = s->force_memory = NULL;
	s->force = NULL;
}
