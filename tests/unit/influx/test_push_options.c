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
	                                       .spool = "/s",
	                                       .every_ns = 1,
	                                       .spool_mb = 2,
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

	TEST_ASSERT_EQUAL_INT(0, push_options_take(&options, &face));
	return options;
}

static void test_each_key_that_is_another_makes_other_options(void)
{
	const struct push_options before = taken();
	const struct config_influx is = config.influx;
	struct push_options now = taken();

	TEST_ASSERT_TRUE(push_options_same(&before, &now));
	for (int key = 0; key < 7; key++) {
		struct config_influx *influx = &config.influx;

		*influx = is;
		influx->url = key == 0 ? "http://other/write" : is.url;
		influx->token_file = key == 1 ? NULL : is.token_file;
		influx->measurement = key == 2 ? "plant" : is.measurement;
		influx->spool = key == 3 ? "/other" : is.spool;
		influx->every_ns += key == 4;
		influx->spool_mb += key == 5;
		influx->clock_wait_ns += key == 6;
		now = taken();
		TEST_ASSERT_FALSE(push_options_same(&before, &now));
	}
}

static void test_without_a_block_there_is_nowhere_to_push(void)
{
	struct push_options options;

	config.influx.given = false;
	options = taken();
	TEST_ASSERT_EQUAL_STRING("", options.url);
}

static void test_the_option_of_the_command_line_counts_for_the_spool(void)
{
	struct push_options options;
	char longest[HISTORY_PATH + 1] = "";

	arguments.option = "/given";
	options = taken();
	TEST_ASSERT_EQUAL_STRING("/given", options.spool);
	memset(longest, 'x', sizeof(longest) - 1);
	arguments.option = longest;
	TEST_ASSERT_LESS_THAN_INT(0, push_options_take(&options, &face));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_each_key_that_is_another_makes_other_options);
	RUN_TEST(test_without_a_block_there_is_nowhere_to_push);
	RUN_TEST(test_the_option_of_the_command_line_counts_for_the_spool);
	return UNITY_END();
}
