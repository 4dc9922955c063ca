/* SPDX-License-Identifier: MIT */
#include "scene.h"

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
static struct scene_property *find(struct scene *s, const char *path)
{
	if (strncmp(path, "/alarm/", 7) == 0)
		path += 6;
	for (unsigned i = 0; i < s->property_count; i++)
		if (strcmp(s->properties[i].path, path) == 0)
			return &s->properties[i];
	return NULL;
}

void scene_put(struct scene *s, const char *path, const char *text, int err)
{
	struct scene_property *p = find(s, path);

	if (!p) {
		TEST_ASSERT_LESS_THAN(SCENE_ITEMS * 2, s->property_count);
		p = &s->properties[s->property_count++];
		p->path = path;
	}
	p->err = err;
	snprintf(p->text, sizeof(p->text), "%s", text ? text : "");
}

void scene_refuse_writes(struct scene *s, const char *path, int err)
{
	find(s, path)->write_err = err;
}

const char *scene_at(struct scene *s, const char *path)
{
	struct scene_property *p = find(s, path);

	return p ? p->text : NULL;
}

void scene_init(struct scene *s)
{
	*s = (struct scene){ .now_ns = 1000 * SCENE_S, .depth = 1, .latency_ns = SCENE_MS };
	s->target.text = "scene";
	s->config = (struct config){
		.file = "scene.rio",
		.targets = &s->target,
		.target_count = 1,
		.max_cons_alarms = 5,
		.max_retries = 3,
		.timeout_ns = 20 * SCENE_S,
		.period_ns = 100 * SCENE_MS,
		.alarm_period_ns = 50 * SCENE_MS,
		.items = s->items,
	};
}

static void note(struct scene *s, char what, const char *path, const char *text)
{
	size_t used = strlen(s->trace);

	snprintf(s->trace + used, sizeof(s->trace) - used, "%c %s%s%s\n", what, path,
	         what == 'W' ? "=" : "", text);
}

static int64_t latency_of(const struct scene *s, const char *path, bool structure)
{
	if (structure)
		return 0;
	return s->slow && strcmp(path, s->slow) == 0 ? s->slow_ns : s->latency_ns;
}

static int submit(void *ctx, struct bus_req *req)
{
	struct scene *s = ctx;
	bool structure = strncmp(req->path, "/structure/", 11) == 0;
	char text[128] = "";
	unsigned values = 0;

	if (s->refuses || s->pending_count + s->swallowed_count == s->depth)
		return -EAGAIN;
	if (structure) {
		s->structure_reads++;
	} else if (req->op == BUS_DIR) {
		s->lists++;
		if (s->trace_lists)
			note(s, 'D', req->path, text);
	} else if (req->op == BUS_WRITE) {
		s->writes++;
		snprintf(text, sizeof(text), "%.*s", (int)req->len, (const char *)req->data);
		note(s, 'W', req->path, text);
	} else {
		s->reads++;
		note(s, req->fresh ? 'r' : 'R', req->path, text);
	}
	if (s->mute && !structure) {
		s->swallowed[s->swallowed_count++] = req;
		return 0;
	}
	s->pending[s->pending_count++] =
		(struct scene_pending){ req, s->now_ns + latency_of(s, req->path, structure) };
	for (unsigned i = 0; i < s->pending_count; i++)
		values += strncmp(s->pending[i].req->path, "/structure/", 11) != 0;
	if (values > s->most_pending)
		s->most_pending = values;
	return 0;
}

void scene_start(struct scene *s)
{
	static struct image_signal signals[SCENE_ITEMS];
	static struct command_signal names[SCENE_ITEMS];
	static struct image_counter counters[64];
	const char *targets[1] = { "scene" };
	struct image_plan plan = {
		.signals = signals,
		.signal_count = s->config.item_count,
		.targets = targets,
		.target_count = 1,
		.counters = counters,
		.counter_count = engine_counter_count(1),
		.generation = 1,
		.start_id = 7,
		.pid = 1,
		.start_ns = s->now_ns,
		.period_ns = s->config.period_ns,
	};
	struct engine_setup setup = {
		.config = &s->config,
		.ports = &s->port,
		.port_count = 1,
		.image = &s->image,
		.commands = &s->commands,
		.start_ns = s->now_ns,
	};
	size_t size;

	engine_counter_plan(1, counters);
	for (unsigned i = 0; i < s->config.item_count; i++) {
		const struct config_item *item = &s->items[i];

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
	image_build(&plan, s->image_memory, &s->image);
	s->command_plan = (struct command_plan){ .signals = names,
		                                 .signal_count = s->config.item_count,
		                                 .text_cap = 1024,
		                                 .generation = 1,
		                                 .start_id = 7,
		                                 .pid = 1 };
	size = commands_size(&s->command_plan);
	s->command_memory = aligned_alloc(64, (size + 63) / 64 * 64);
	memset(s->command_memory, 0, size);
	TEST_ASSERT_EQUAL_INT(0, commands_build(&s->command_plan, s->command_memory, &s->commands));
	s->port = (struct engine_port){ .target = "scene", .depth = s->depth, .searches = s->searches,
		                        .submit = submit,
		                        .ctx = s };
	TEST_ASSERT_EQUAL_INT(0, engine_create(&setup, &s->engine));
}

void scene_down(struct scene *s, int err)
{
	struct bus_event event = { .news = BUS_DOWN, .err = err };

	while (s->pending_count) {
		struct bus_req *req = s->pending[--s->pending_count].req;

		scene_answer(s, req->id, err, NULL, req);
	}
	engine_event(s->engine, 0, &event, s->now_ns);
}

void scene_answer(struct scene *s, uint32_t id, int err, const char *text, struct bus_req *req)
{
	struct bus_answer answer = { .id = id, .err = err, .measured_ns = s->now_ns };

	if (!err && text && req && req->op != BUS_WRITE) {
		answer.len = (uint32_t)strlen(text);
		TEST_ASSERT_LESS_OR_EQUAL(req->len, answer.len);
		memcpy(req->data, text, answer.len);
	}
	engine_answer(s->engine, 0, &answer, s->now_ns);
}

static void deliver(struct scene *s, unsigned index)
{
	struct bus_req *req = s->pending[index].req;
	struct scene_property *p = find(s, req->op == BUS_DIR ? "/alarm" : req->path);

	s->pending[index] = s->pending[--s->pending_count];
	if (!p) {
		scene_answer(s, req->id, req->op == BUS_DIR ? -EOPNOTSUPP : -ENOENT, NULL, req);
		return;
	}
	if (req->op == BUS_WRITE && p->write_err) {
		scene_answer(s, req->id, p->write_err, NULL, req);
		return;
	}
	if (s->on_read && req->op != BUS_WRITE)
		s->on_read(s, req->path);
	if (req->op == BUS_WRITE && !p->err && s->on_write)
		s->on_write(s, req->path, (const char *)req->data, req->len);
	if (req->op == BUS_WRITE && !p->err)
		snprintf(p->text, sizeof(p->text), "%.*s", (int)req->len, (const char *)req->data);
	scene_answer(s, req->id, p->err, p->text, req);
}

static bool deliver_structure(struct scene *s)
{
	for (unsigned i = 0; i < s->pending_count; i++)
		if (strncmp(s->pending[i].req->path, "/structure/", 11) == 0) {
			deliver(s, i);
			return true;
		}
	return false;
}

void scene_up(struct scene *s)
{
	struct bus_event event = { .news = BUS_UP };

	engine_event(s->engine, 0, &event, s->now_ns);
	do {
		engine_step(s->engine, s->now_ns);
	} while (deliver_structure(s));
}

void scene_run(struct scene *s, int64_t ns)
{
	int64_t end = s->now_ns + ns;

	for (;;) {
		int64_t next = engine_step(s->engine, s->now_ns);
		int soonest = -1;

		for (unsigned i = 0; i < s->pending_count; i++)
			if (s->pending[i].when_ns <= next) {
				next = s->pending[i].when_ns;
				soonest = (int)i;
			}
		TEST_ASSERT_TRUE_MESSAGE(next > s->now_ns || soonest >= 0, "the engine spins");
		if (next > end)
			break;
		s->now_ns = next;
		if (soonest >= 0)
			deliver(s, (unsigned)soonest);
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

uint64_t scene_counter(struct scene *s, const char *name)
{
	struct image_counter plan[64];

	engine_counter_plan(1, plan);
	for (unsigned i = 0; i < engine_counter_count(1); i++)
		if (strcmp(plan[i].name, name) == 0)
			return engine_counter(s->engine, i);
	TEST_FAIL_MESSAGE("no such counter");
	return 0;
}
