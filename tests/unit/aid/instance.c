/* SPDX-License-Identifier: MIT */
/* An instance of owsd without owsd: makes and fills its segments. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "unity.h"

#include "src/shm/carry.h"
#include "src/shm/futex.h"
#include "src/signal/value.h"
#include "tests/unit/aid/instance.h"

static const char *const targets[] = {"localhost:4304", "w1"};
static const struct image_counter counters[] = {{"alarms", 0xffffffffu}, {"keepalives", 0}};

void instance_make(struct instance *in, const char *name, uint32_t generation, int64_t start_ns,
                   const struct instance_signal *signals, uint32_t count)
{
	struct image_signal *image = calloc(count + 1, sizeof(*image));
	struct command_signal *command = calloc(count + 1, sizeof(*command));
	struct image_plan plan = {
		.signals = image,
		.signal_count = count,
		.targets = targets,
		.target_count = 2,
		.counters = counters,
		.counter_count = 2,
		.served = "owserver:/run/owsd/T.sock",
		.generation = generation,
		.start_id = 0x1000 + generation,
		.pid = (int32_t)getpid(),
		.start_ns = start_ns,
		.period_ns = INSTANCE_S / 10,
	};
	struct command_plan commands = {
		.signals = command,
		.signal_count = count,
		.text_cap = INSTANCE_TEXT,
		.generation = generation,
		.start_id = 0x1000 + generation,
		.pid = (int32_t)getpid(),
	};

	TEST_ASSERT_NOT_NULL(image);
	TEST_ASSERT_NOT_NULL(command);
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
			.type = signals[i].type,
			.flags = signals[i].output ? OWS_RECORD_OUTPUT : 0,
			.text_cap = text ? INSTANCE_TEXT : 0,
			.per_factor = i + 1,
			.stale_after_ns = signals[i].stale_after_ns,
		};
		command[i] = (struct command_signal){
			.name = signals[i].name,
			.path = signals[i].path,
			.type = signals[i].type,
		};
	}
	TEST_ASSERT_EQUAL(
		0, segment_create(in->name, SEGMENT_IMAGE, image_size(&plan), &in->image_memory));
	image_build(&plan, in->image_memory.base, &in->image);
	TEST_ASSERT_EQUAL(0, segment_create(in->name, SEGMENT_COMMAND, commands_size(&commands),
	                                    &in->command_memory));
	TEST_ASSERT_EQUAL(0, commands_build(&commands, in->command_memory.base, &in->commands));
	free(image);
	free(command);
}

void instance_show(struct instance *in)
{
	image_state(&in->image, OWS_STATE_LIVE);
	commands_state(&in->commands, OWS_STATE_LIVE);
	TEST_ASSERT_EQUAL(0, segment_show(in->name, &in->command_memory));
	TEST_ASSERT_EQUAL(0, segment_show(in->name, &in->image_memory));
}

void instance_start(struct instance *in, const char *name, const struct instance_signal *signals,
                    uint32_t count)
{
	int64_t now = ows_now();

	instance_make(in, name, 1, now, signals, count);
	instance_beat(in, now, 0);
	instance_show(in);
}

void instance_reload(struct instance *in, const struct instance_signal *signals, uint32_t count)
{
	struct instance old = *in;
	char name[SEGMENT_NAME_MAX + 1];

	memcpy(name, old.name, sizeof(name));
	*strrchr(name, '.') = '\0';
	instance_make(in, name, old.generation + 1, old.start_ns, signals, count);
	instance_beat(in, ows_now(), 0);
	commands_state(&old.commands, OWS_STATE_RETIRED);
	TEST_ASSERT_GREATER_OR_EQUAL(
		0, commands_carry(&in->commands, old.commands.base, old.commands.size, false));
	instance_show(in);
	image_state(&old.image, OWS_STATE_RETIRED);
	segment_wake(&old.image.header->news, 1000);
	instance_leave(&old);
}

void instance_leave(struct instance *in)
{
	commands_forget(&in->commands);
	segment_close(&in->command_memory);
	segment_close(&in->image_memory);
}

void instance_end(struct instance *in)
{
	instance_leave(in);
	segment_remove(in->name, SEGMENT_IMAGE);
	segment_remove(in->name, SEGMENT_COMMAND);
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

static struct ows_sample good(int64_t measured_ns)
{
	return (struct ows_sample){
		.measured_ns = measured_ns,
		.tried_ns = measured_ns,
		.quality = OWS_Q_GOOD,
		.target = 1,
		.count = 1,
	};
}

void instance_put(struct instance *in, uint32_t record, int64_t value, int64_t measured_ns)
{
	struct ows_sample sample = good(measured_ns);
	struct ows_attrs attrs = {.flags = OWS_ATTR_READ_ENABLE};

	sample.value = value;
	image_publish(&in->image, record, &sample, &attrs, NULL);
	image_news(&in->image);
}

void instance_put_double(struct instance *in, uint32_t record, double value, int64_t measured_ns)
{
	instance_put(in, record, value_of_double(value), measured_ns);
}

void instance_put_text(struct instance *in, uint32_t record, const char *text, int64_t measured_ns)
{
	struct ows_sample sample = good(measured_ns);
	struct ows_attrs attrs = {0};

	sample.len = (uint32_t)strlen(text);
	image_publish(&in->image, record, &sample, &attrs, text);
	image_news(&in->image);
}
