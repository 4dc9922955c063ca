/* SPDX-License-Identifier: MIT */
/* Adapters whose bytes take any time or none, steady or not, under clocks of any resolution. */
#include <stdio.h>

#include "hal/ds2482/master.h"
#include "unity.h"

#include "hal/sim/scenario.h"
#include "tests/unit/aid/ds2482_scene.h"
#include "tests/unit/aid/parts.h"

static int64_t (*true_now)(void *ctx);
static int (*true_wait)(void *ctx, int fd, short events, int64_t until_ns);
static int64_t resolution_ns;
static const int64_t *pace; /* ns of a byte, one for each wait in turn */
static unsigned paces, turn;

void setUp(void)
{
	ds_begin();
	true_now = ds.host.env.now;
	true_wait = ds.host.env.wait;
	resolution_ns = 1;
	pace = NULL;
	paces = turn = 0;
}

void tearDown(void)
{
	ds_end();
}

static int64_t coarse_now(void *ctx)
{
	int64_t now = true_now(ctx);

	return now - now % resolution_ns;
}

static void set_pace(int64_t byte_ns)
{
	ds.net.hz = byte_ns ? (uint32_t)(INT64_C(9000000000) / byte_ns) : UINT32_MAX;
}

static int varying_wait(void *ctx, int fd, short events, int64_t until_ns)
{
	if (paces)
		set_pace(pace[turn++ % paces]);
	return true_wait(ctx, fd, events, until_ns);
}

static void open_paced(const char *combine, int64_t byte_ns)
{
	const struct ds2482_source source = {
		.open = ds_open_adapter, .destroy = ds_forget, .name = "test"};
	char scenario[120];

	snprintf(scenario, sizeof(scenario),
	         "i2c combine %s\nchip DS2482-100 0x18\nDS18B20 28.000000000001 as t", combine);
	TEST_ASSERT_EQUAL_INT_MESSAGE(
		0, sim_scenario_parse("test", scenario, &ds.net, ds.why, sizeof(ds.why)), ds.why);
	set_pace(byte_ns);
	ds.host.env.now = coarse_now;
	ds.host.env.wait = varying_wait;
	TEST_ASSERT_EQUAL_INT(0, ds2482_create(&ds_ops, &ds.host.env, &source, "", &ds.master,
	                                       ds.why, sizeof(ds.why)));
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, ds.master->ops->open(ds.master, ds.why, sizeof(ds.why)),
	                              ds.why);
	ds.wire = ds.master->ops->channel(ds.master, 0);
}

static const char *const combines[] = {"any", "one-read", "smbus"};
#define COMBINES (sizeof(combines) / sizeof(combines[0]))

/* Calls that failed until ten in a row were right. Behind one that failed others use the wire. */
static unsigned errors_until_steady(unsigned most)
{
	unsigned failed = 0, right = 0;

	while (right < 10 && failed <= most) {
		uint8_t scratchpad[9];

		if (ds_read_scratchpad("t", scratchpad) == 0) {
			ds_check_scratchpad();
			right++;
		} else {
			failed++;
			right = 0;
			part_reset(ds.wire);
		}
	}
	return failed;
}

static void test_an_adapter_of_any_pace_reads_without_an_error(void)
{
	static const int64_t bytes_ns[] = {0,    50,    1000,  5000,   8999,    9000,
	                                   9001, 22500, 90000, 100000, 1000000, 10000000};

	for (size_t c = 0; c < COMBINES; c++) {
		for (size_t i = 0; i < sizeof(bytes_ns) / sizeof(bytes_ns[0]); i++) {
			setUp();
			open_paced(combines[c], bytes_ns[i]);
			for (unsigned n = 0; n < 5; n++)
				ds_check_scratchpad();
			tearDown();
		}
	}
}

static void test_bytes_faster_than_any_wire_are_no_measure_of_time(void)
{
	static const int64_t bytes_ns[] = {0, 1, 50, 1000, 5000, 8500};

	for (size_t i = 0; i < sizeof(bytes_ns) / sizeof(bytes_ns[0]); i++) {
		setUp();
		open_paced("any", bytes_ns[i]);
		TEST_ASSERT_EQUAL_INT64(0, ((struct ds2482_master *)ds.master)->byte_ns);
		tearDown();
	}
}

/* What such a clock hides or makes of a byte is put right, and soon. */
static void test_a_pace_measured_with_a_coarse_clock_costs_a_few_errors_at_most(void)
{
	static const int64_t steps_ns[] = {1000, 100000, 1000000, 4000000, 10000000};
	static const int64_t bytes_ns[] = {0, 1000, 9000, 22500, 90000};

	for (size_t c = 0; c < COMBINES; c++) {
		for (size_t s = 0; s < sizeof(steps_ns) / sizeof(steps_ns[0]); s++) {
			for (size_t i = 0; i < sizeof(bytes_ns) / sizeof(bytes_ns[0]); i++) {
				char text[80];

				setUp();
				resolution_ns = steps_ns[s];
				snprintf(text, sizeof(text), "%s, step %lld, byte %lld",
				         combines[c], (long long)steps_ns[s],
				         (long long)bytes_ns[i]);
				open_paced(combines[c], bytes_ns[i]);
				resolution_ns = 1;
				TEST_ASSERT_LESS_OR_EQUAL_UINT_MESSAGE(25, errors_until_steady(100),
				                                       text);
				tearDown();
			}
		}
	}
}

static void test_an_adapter_that_became_fast_or_varies_is_put_right(void)
{
	static const int64_t became[][4] = {
		{0, 0, 0, 0},         {1000, 1000, 1000, 1000}, {22500, 0, 1000, 9000},
		{0, 90000, 0, 90000}, {100, 10000, 1000, 5000}, {200000, 0, 22500, 1},
	};
	static const int64_t bytes_ns[] = {9000, 22500, 90000, 1000000};

	for (size_t c = 0; c < COMBINES; c++) {
		for (size_t b = 0; b < sizeof(became) / sizeof(became[0]); b++) {
			for (size_t i = 0; i < sizeof(bytes_ns) / sizeof(bytes_ns[0]); i++) {
				char text[80];

				setUp();
				open_paced(combines[c], bytes_ns[i]);
				pace = became[b];
				paces = 4;
				snprintf(text, sizeof(text), "%s, became %zu, byte %lld",
				         combines[c], b, (long long)bytes_ns[i]);
				TEST_ASSERT_LESS_OR_EQUAL_UINT_MESSAGE(60, errors_until_steady(200),
				                                       text);
				tearDown();
			}
		}
	}
}

/* Noise that looks like an early reading now and then does not make a real wire slow for ever. */
static void test_noise_over_hours_leaves_a_real_wire_read_on(void)
{
	const struct ds2482_master *master;

	open_paced("any", 22500);
	master = (const struct ds2482_master *)ds.master;
	for (unsigned n = 0; n < 100; n++) {
		uint8_t scratchpad[9];

		ds_event("refuse-data 0x18 each 15");
		ds_read_scratchpad("t", scratchpad);
		ds_event("end refuse-data 0x18");
		ds.host.now += 20 * HOST_S;
		ds_check_scratchpad();
		TEST_ASSERT_GREATER_OR_EQUAL_INT64(9000, master->byte_ns);
	}
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_an_adapter_of_any_pace_reads_without_an_error);
	RUN_TEST(test_bytes_faster_than_any_wire_are_no_measure_of_time);
	RUN_TEST(test_a_pace_measured_with_a_coarse_clock_costs_a_few_errors_at_most);
	RUN_TEST(test_an_adapter_that_became_fast_or_varies_is_put_right);
	RUN_TEST(test_noise_over_hours_leaves_a_real_wire_read_on);
	return UNITY_END();
}
