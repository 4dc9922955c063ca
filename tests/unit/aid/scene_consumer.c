/* SPDX-License-Identifier: MIT */
/* Reads a scene's image as a consumer does. */
#include <string.h>

#include "unity.h"

#include "src/daemon/engine/counters.h"
#include "src/ground/signal/value.h"
#include "src/memory/shm/reader.h"
#include "tests/unit/aid/scene.h"

struct ows_sample scene_sample(struct scene *s, unsigned record)
{
	const struct ows_record *r = &s->image.records[record];

	return r->slot[(r->seq >> 1) & 1].sample;
}

struct ows_origin_entry scene_origin(struct scene *s, unsigned record)
{
	return s->image.origins[record];
}

void scene_expect(struct scene *s, unsigned record, uint8_t quality, unsigned target)
{
	struct ows_sample sample = scene_sample(s, record);

	TEST_ASSERT_EQUAL_HEX8(quality, sample.quality);
	TEST_ASSERT_EQUAL_UINT(target, sample.target);
}

struct ows_device_entry scene_device(struct scene *s, unsigned index)
{
	struct ows_device_entry entry;

	TEST_ASSERT_LESS_THAN_UINT32(s->image.device_count, index);
	TEST_ASSERT_TRUE(reader_entry(&s->image.devices[index], &entry, sizeof(entry)));
	return entry;
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
