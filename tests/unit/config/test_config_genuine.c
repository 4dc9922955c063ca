/* SPDX-License-Identifier: MIT */
/* Configurations of the shapes that REXYGEN's example projects have load as they are. */
#include <stdlib.h>
#include <string.h>

#include "unity.h"

#include "src/config/read/config.h"
#include "src/config/read/load.h"
#include "src/ground/signal/value.h"
#include "tests/unit/aid/said.h"

#define DATA "tests/unit/data/"

static struct config *config;

static void load(const char *file)
{
	said_must_not_begin();
	TEST_ASSERT_EQUAL_INT(0, config_load(file, &report, &config));
	TEST_ASSERT_EQUAL_UINT(0, report.errors + report.warnings);
	TEST_ASSERT_EQUAL_STRING(file, config->file);
	TEST_ASSERT_EQUAL_UINT(1, config->target_count);
	TEST_ASSERT_EQUAL_INT(CONFIG_FIRST, config->targets[0].relation);
}

static void expect_item(unsigned index, const char *name, const char *path, enum ows_type type,
                        bool output, bool fresh, const char *init)
{
	const struct config_item *item = &config->items[index];
	int64_t value;

	TEST_ASSERT_TRUE(index < config->item_count);
	TEST_ASSERT_EQUAL_STRING(name, item->name);
	TEST_ASSERT_EQUAL_STRING(path, item->path);
	TEST_ASSERT_EQUAL_INT(type, item->type);
	TEST_ASSERT_EQUAL(output, item->output);
	TEST_ASSERT_EQUAL(!output, item->readable);
	TEST_ASSERT_EQUAL(output, item->writable);
	TEST_ASSERT_EQUAL(fresh, item->fresh);
	TEST_ASSERT_TRUE(item->has_init);
	TEST_ASSERT_FALSE(item->has_safe);
	TEST_ASSERT_EQUAL_STRING(init, item->init_text);
	TEST_ASSERT_EQUAL_INT(0, value_parse(type, init, &value));
	TEST_ASSERT_EQUAL_INT64(value, item->init_value);
	TEST_ASSERT_EQUAL_UINT32(1, item->per_factor);
	TEST_ASSERT_EQUAL_INT64(0, item->stale_after_ns);
	TEST_ASSERT_FALSE(item->alarm);
	TEST_ASSERT_NULL(item->latch_alarm);
	TEST_ASSERT_NULL(item->por_alarm);
	TEST_ASSERT_NULL(item->set_alarm);
	TEST_ASSERT_NULL(item->reset_latch);
}

void setUp(void)
{
	config = NULL;
}

void tearDown(void)
{
	config_free(config);
}

static void test_a_relay_and_an_input_of_a_ds2408(void)
{
	load(DATA "relay_and_inputs.rio");
	TEST_ASSERT_EQUAL_STRING("localhost:4304", config->targets[0].text);
	TEST_ASSERT_EQUAL_UINT(5, config->max_cons_alarms);
	TEST_ASSERT_EQUAL_UINT(3, config->max_retries);
	TEST_ASSERT_EQUAL_INT64(10000000000, config->timeout_ns);
	TEST_ASSERT_EQUAL_INT64(100000000, config->period_ns);
	TEST_ASSERT_EQUAL_INT64(50000000, config->alarm_period_ns);
	TEST_ASSERT_EQUAL_UINT(2, config->item_count);
	expect_item(0, "pumps", "/29.4C0A17000000/PIO.BYTE", OWS_BYTE, true, false, "0");
	expect_item(1, "floats", "/29.4C0A17000000/sensed.BYTE", OWS_BYTE, false, false, "0");
	TEST_ASSERT_EQUAL_INT(8, config->items[0].line);
	TEST_ASSERT_EQUAL_INT(14, config->items[1].line);
}

static void test_a_target_without_port(void)
{
	load(DATA "one_thermometer.rio");
	TEST_ASSERT_EQUAL_STRING("localhost", config->targets[0].text);
	TEST_ASSERT_EQUAL_INT64(20000000000, config->timeout_ns);
	TEST_ASSERT_EQUAL_UINT(1, config->item_count);
	expect_item(0, "greenhouse", "/28.6E2B90040000/temperature12", OWS_DOUBLE, false, false,
	            "18");
}

static void test_four_thermometers(void)
{
	load(DATA "four_thermometers.rio");
	TEST_ASSERT_EQUAL_UINT(4, config->item_count);
	expect_item(0, "yard", "/28.2A71C5060000/temperature12", OWS_DOUBLE, false, false, "-6.3");
	expect_item(3, "boiler", "/28.7E62AB030000/temperature12", OWS_DOUBLE, false, false,
	            "51.62");
}

static void test_uncached_in_path_and_flag_mean_the_same_once(void)
{
	load(DATA "light_and_humidity.rio");
	TEST_ASSERT_EQUAL_UINT(1, config->max_retries);
	TEST_ASSERT_EQUAL_UINT(5, config->item_count);
	expect_item(0, "daylight", "/26.5D93E2010000/vis", OWS_DOUBLE, false, true, "0");
	expect_item(4, "sensor", "/26.5D93E2010000/VAD", OWS_DOUBLE, false, true, "0");
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_relay_and_an_input_of_a_ds2408);
	RUN_TEST(test_a_target_without_port);
	RUN_TEST(test_four_thermometers);
	RUN_TEST(test_uncached_in_path_and_flag_mean_the_same_once);
	return UNITY_END();
}
