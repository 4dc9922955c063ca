/* SPDX-License-Identifier: MIT */
/* Tests of what owsd-influx takes from its block, and of what makes it begin anew. */
#include <string.h>

#include "unity.h"

#include "src/faces/influx/options.h"
#include "src/faces/kit/face.h"

static struct face_arguments arguments;
static const struct face_ops ops = {.program = "owsd-influx"};
static struct config config;
static struct face face;

void setUp(void)
{
	config.influx = (struct config_influx){.given = true,
	                                       .url = "http://h/write",
	                                       .token_file = "/t",
	                                       .measurement = "ows",
	                                       .every_ns = 1,
	                                       .clock_wait_ns = 3};
	arguments = (struct face_arguments){.program = "owsd-influx", .instance = "OWS"};
	face = (struct face){.ops = &ops, .arguments = &arguments, .config = &config};
}

void tearDown(void)
{
}

static struct push_options taken(void)
{
	struct push_options options;

	push_options_take(&options, &face);
	return options;
}

static void test_each_key_that_is_another_makes_other_options(void)
{
	const struct push_options before = taken();
	const struct config_influx is = config.influx;
	struct push_options now = taken();

	TEST_ASSERT_EQUAL_MEMORY(&before, &now, sizeof(now));
	for (int key = 0; key < 5; key++) {
		struct config_influx *influx = &config.influx;

		*influx = is;
		influx->url = key == 0 ? "http://other/write" : is.url;
		influx->token_file = key == 1 ? NULL : is.token_file;
		influx->measurement = key == 2 ? "plant" : is.measurement;
		influx->every_ns += key == 3;
		influx->clock_wait_ns += key == 4;
		now = taken();
		TEST_ASSERT_TRUE(memcmp(&before, &now, sizeof(now)) != 0);
	}
}

static void test_without_a_block_there_is_nowhere_to_push(void)
{
	struct push_options options;

	config.influx.given = false;
	options = taken();
	TEST_ASSERT_EQUAL_STRING("", options.url);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_each_key_that_is_another_makes_other_options);
	RUN_TEST(test_without_a_block_there_is_nowhere_to_push);
	return UNITY_END();
}
