/* SPDX-License-Identifier: MIT */
/* An instance of owsd without owsd: makes and fills its image, and welcomes controllers. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "unity.h"

#include "src/ground/signal/value.h"
#include "src/memory/shm/futex.h"
#include "tests/unit/aid/folder.h"
#include "tests/unit/aid/instance.h"

static const char *const targets[] = {"localhost:4304", "w1"};
static const struct image_counter counters[] = {{"alarms", 0xffffffffu}, {"keepalives", 0}};

void instance_make(struct instance *in, const char *name, uint32_t generation, int64_t start_ns,
                   const struct instance_signal *signals, uint32_t count)
{
	struct image_signal *image = calloc(count + 1, sizeof(*image));
	struct image_meta *metas = calloc(count + 1, sizeof(*metas));
	uint32_t *devices = calloc(count + 1, sizeof(*devices));
	struct image_plan plan = {
		.signals = image,
		.signal_count = count,
		.targets = targets,
		.target_count = 2,
		.counters = counters,
		.counter_count = 2,
		.devices = devices,
		.log_lines = 8,
		.served = "owserver:/run/owsd/T.sock",
		.generation = generation,
		.start_id = 0x1000 + generation,
		.pid = (int32_t)getpid(),
		.start_ns = start_ns,
		.period_ns = INSTANCE_S / 10,
	};

	TEST_ASSERT_TRUE(image && metas && devices);
	memset(in, 0, sizeof(*in));
	snprintf(in->name, sizeof(in->name), "%.20s.%d", name, (int)getpid());
	in->generation = generation;
	in->start_ns = start_ns;
	in->signals = signals;
	in->count = count;
	for (uint32_t i = 0; i < count; i++) {
		bool text = signals[i].type == OWS_STRING;

		image[i] = (struct image_signal){
			.name = signals[i].name,
			.path = signals[i].path,
			.identity = signals[i].identity,
			.type = signals[i].type,
			.flags = signals[i].output ? OWS_RECORD_OUTPUT : 0,
			.text_cap = text ? INSTANCE_TEXT : 0,
			.per_factor = i + 1,
			.stale_after_ns = signals[i].stale_after_ns,
			.meta = &metas[i],
		};
		metas[i] = image_no_meta;
		metas[i].device = signals[i].device;
		metas[i].family = signals[i].device ? "DS18B20" : NULL;
		if (signals[i].device)
			devices[plan.device_count++] = i;
	}
	TEST_ASSERT_EQUAL(0, segment_create(folder_dir(), in->name, SEGMENT_IMAGE,
	                                    image_size(&plan), &in->image_memory));
	image_build(&plan, in->image_memory.base, &in->image);
	free(image);
	free(metas);
	free(devices);
}

#define TYPES_MAX 256
static const uint8_t *types_of(const struct instance *in)
{
	static uint8_t types[TYPES_MAX];

	TEST_ASSERT_LESS_OR_EQUAL(TYPES_MAX, in->count);
	for (uint32_t i = 0; i < in->count; i++)
		types[i] = in->signals[i].type;
	return types;
}

static void show_image(struct instance *in)
{
	image_state(&in->image, OWS_STATE_LIVE);
	TEST_ASSERT_EQUAL(0, segment_show(in->name, &in->image_memory));
}

void instance_show(struct instance *in)
{
	in->door = malloc(sizeof(*in->door));
	TEST_ASSERT_NOT_NULL(in->door);
	door_open(in->door, in->name, in->generation, in->image.header->start_id, types_of(in),
	          in->count, INSTANCE_TEXT);
	show_image(in);
}

void instance_start(struct instance *in, const char *name, const struct instance_signal *signals,
                    uint32_t count)
{
	int64_t now = ows_now();

	instance_make(in, name, 1, now, signals, count);
	instance_lives_on(in);
	instance_show(in);
}

/* The signal of that name before, else 0xffffffff. */
static uint32_t row_before(const struct instance *old, const char *name)
{
	for (uint32_t i = 0; i < old->count; i++)
		if (strcmp(old->signals[i].name, name) == 0)
			return i;
	return 0xffffffffu;
}

void instance_reload(struct instance *in, const struct instance_signal *signals, uint32_t count)
{
	struct instance old = *in;
	char name[SEGMENT_NAME_MAX + 1];
	uint32_t rows[TYPES_MAX];

	memcpy(name, old.name, sizeof(name));
	*strrchr(name, '.') = '\0';
	instance_make(in, name, old.generation + 1, old.start_ns, signals, count);
	in->image.header->period_ns = old.image.header->period_ns;
	instance_beat(in, ows_now(), 0);
	for (uint32_t i = 0; i < count; i++)
		rows[i] = row_before(&old, signals[i].name);
	in->door = old.door;
	show_image(in);
	door_reload(in->door, in->generation, in->image.header->start_id, types_of(in), count,
	            INSTANCE_TEXT, rows);
	image_state(&old.image, OWS_STATE_RETIRED);
	segment_wake(&old.image.header->news, 1000);
	old.door = NULL;
	instance_leave(&old);
}

void instance_kill(struct instance *in)
{
	if (in->door)
		door_close(in->door);
	free(in->door);
	in->door = NULL;
}

void instance_leave(struct instance *in)
{
	instance_kill(in);
	segment_close(&in->image_memory);
}

void instance_end(struct instance *in)
{
	instance_leave(in);
	remove(folder_file(in->name, "image"));
}

struct controller_memory *instance_controller(struct instance *in, unsigned i)
{
	return &door_controller(in->door, i)->memory;
}

struct controller_command instance_command(struct instance *in, unsigned i, uint32_t record)
{
	struct controller_command command;

	controller_load(instance_controller(in, i), record, &command);
	return command;
}

struct ows_command_slot *instance_slot(struct instance *in, unsigned i, uint32_t record)
{
	struct controller_memory *memory = instance_controller(in, i);

	return (struct ows_command_slot *)(void *)(memory->base + memory->layout->header.slot_off) +
	       record;
}

unsigned instance_controllers(struct instance *in)
{
	return door_count(in->door);
}

void instance_beat(struct instance *in, int64_t now_ns, uint32_t period)
{
	struct ows_sample sample = {.measured_ns = now_ns, .value = 3, .quality = OWS_Q_GOOD};
	struct ows_attrs attrs = {.per_base = period, .transactions = 77};

	image_publish(&in->image, 0, &sample, &attrs, NULL);
	image_news(&in->image);
}

void instance_lives_on(struct instance *in)
{
	in->image.header->period_ns = INSTANCE_PATIENCE / 3;
	instance_beat(in, ows_now(), 0);
}

void instance_dies_soon(struct instance *in)
{
	in->image.header->period_ns = INSTANCE_S / 10;
}

static struct ows_sample good(const struct instance *in, int64_t measured_ns)
{
	return (struct ows_sample){
		.measured_ns = measured_ns,
		.tried_ns = measured_ns,
		.quality = OWS_Q_GOOD,
		.detail = in->detail,
		.target = 1,
		.count = 1,
	};
}

void instance_put(struct instance *in, uint32_t record, int64_t value, int64_t measured_ns)
{
	struct ows_sample sample = good(in, measured_ns);
	enum ows_type type = (enum ows_type)in->image.records[record].type;
	struct ows_attrs attrs = {.flags = OWS_ATTR_READ_ENABLE,
	                          .raw = value_of_double(value_number(type, value))};

	sample.value = value;
	image_publish(&in->image, record, &sample, &attrs, NULL);
	image_change(&in->image, record);
	image_news(&in->image);
}

void instance_put_double(struct instance *in, uint32_t record, double value, int64_t measured_ns)
{
	instance_put(in, record, value_of_double(value), measured_ns);
}

void instance_put_text(struct instance *in, uint32_t record, const char *text, int64_t measured_ns)
{
	struct ows_sample sample = good(in, measured_ns);
	struct ows_attrs attrs = {0};

	sample.len = (uint32_t)strlen(text);
	image_publish(&in->image, record, &sample, &attrs, text);
	image_change(&in->image, record);
	image_news(&in->image);
}
