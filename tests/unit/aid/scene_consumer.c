/* SPDX-License-Identifier: MIT */
/* Reads a scene's segments as a consumer does, and writes to them. */
#include <string.h>

#include "unity.h"

#include "src/engine/counters.h"
#include "src/signal/value.h"
#include "tests/unit/aid/scene.h"

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
	struct ows_command_text *t = (struct ows_command_text *)(void *)((char *)s->command_memory +
	                                                                 entry->text_off);

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

void scene_expect(struct scene *s, unsigned record, uint8_t quality, unsigned target)
{
	struct ows_sample sample = scene_sample(s, record);

	TEST_ASSERT_EQUAL_HEX8(quality, sample.quality);
	TEST_ASSERT_EQUAL_UINT(target, sample.target);
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
