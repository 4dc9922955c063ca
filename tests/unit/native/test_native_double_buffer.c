/* SPDX-License-Identifier: MIT */
/*
 * The experimental double buffer: results are read while the next conversion runs. How often each
 * value is new, and which chips take part.
 */
#include <stdio.h>
#include <string.h>

#include "hal/sim/chips/thermometer.h"
#include "unity.h"

#include "tests/unit/aid/buffered.h"

void setUp(void)
{
	native_begin();
	fleet_begin();
}

void tearDown(void)
{
	native_end();
}

static void judge_minute(void)
{
	fleet_forget();
	fleet_run(host.now + 60 * HOST_S);
	host.events = 0;
	TEST_ASSERT_EQUAL_UINT(0, fleet.wrong);
	TEST_ASSERT_EQUAL_UINT(0, fleet.failed);
	TEST_ASSERT_EQUAL_UINT(0, fleet.older + fleet.newer);
}

static double minute(void)
{
	judge_minute();
	char text[100];
	double ms = 54000.0 * fleet.count / fleet.good;
	snprintf(text, sizeof(text), "%u: %.0f ms, %u early", fleet.count, ms,
	         (unsigned)counted("experimental_early_reads"));
	TEST_MESSAGE(text);
	return ms;
}

/* --- How fast --------------------------------------------------------------------------------- */

/* In turn it would be 950 ms, on this wire without a bridge chip. */
static void test_fifty_are_new_sooner_than_the_wire_can_read_and_start_them(void)
{
	buffered_set_out(50, "DS18B20");
	buffered_start("on");
	buffered_run_trials(480);
	TEST_ASSERT_EQUAL_UINT(6 * 50, counted("experimental_trials"));
	TEST_ASSERT_EQUAL_UINT(0, counted("experimental_doubts"));
	TEST_ASSERT_TRUE(minute() < 830);
	TEST_ASSERT_GREATER_THAN_UINT(1000, counted("experimental_early_reads"));
}

static void test_few_are_new_after_each_conversion(void)
{
	buffered_set_out(5, "DS1822");
	buffered_start("on");
	buffered_run_trials(60);
	TEST_ASSERT_EQUAL_UINT(6 * 5, counted("experimental_trials"));
	TEST_ASSERT_TRUE(minute() < 780);
}

/* Nothing shows that it converted, so its time is that of the start that it showed itself. */
static void test_a_value_that_stays_says_by_its_time_when_it_was_certain(void)
{
	fleet_slope = 1e-6;
	buffered_set_out(8, "DS18B20");
	for (unsigned i = 0; i < 8; i++)
		wire_set(fleet.slave[i], "temperature", 20 + 3 / 16.0 + i);
	buffered_start("on");
	buffered_run(5 * HOST_S);
	buffered_trust(590000);
	buffered_run(60 * HOST_S);
	unsigned stood = 0;
	int64_t oldest = 0;
	for (unsigned i = 0; i < 400; i++) {
		int64_t stamp = buffered_chip(0)->latched_ns;

		fleet_run(host.now + 100 * HOST_MS);
		stood += buffered_chip(0)->latched_ns == stamp;
		oldest = host.now - stamp > oldest ? host.now - stamp : oldest;
	}
	TEST_ASSERT_GREATER_THAN_UINT(300, stood);
	TEST_ASSERT_LESS_THAN_INT64(33 * HOST_S, oldest);
	TEST_ASSERT_EQUAL_UINT(0, fleet.wrong + fleet.failed);
}

static void test_what_is_asked_for_with_pauses_converts_no_more_often(void)
{
	uint32_t id[10];

	buffered_set_out(10, "DS18B20");
	buffered_start("on");
	buffered_run(5 * HOST_S);
	buffered_trust(590000);
	buffered_run(5 * HOST_S);
	fleet.stopped = true;
	buffered_run(5 * HOST_S);
	wire_net.convert_count = 0;
	for (unsigned scan = 0; scan < 20; scan++) {
		for (unsigned i = 0; i < 10; i++)
			id[i] = ask(BUS_READ, BUS_INPUT, true, of(fleet.slave[i], "temperature"),
			            NULL);
		for (unsigned i = 0; i < 10; i++)
			TEST_ASSERT_EQUAL_INT(0, answer_to(id[i])->err);
		forget();
		host_run(&host, bus, host.now + 5 * HOST_S);
	}
	TEST_ASSERT_LESS_OR_EQUAL_UINT(21, wire_net.convert_count);
}

/* --- Who takes part --------------------------------------------------------------------------- */

static void test_nothing_is_tried_without_the_option(void)
{
	buffered_set_out(3, "DS18B20");
	buffered_start("off");
	buffered_run_trials(60);
	TEST_ASSERT_EQUAL_UINT(0, counted("experimental_trials"));
	TEST_ASSERT_EQUAL_UINT(0, counted("experimental_early_reads"));
}

static void test_the_log_says_once_that_it_is_experimental(void)
{
	unsigned notes = 0;

	buffered_set_out(1, "DS18B20");
	buffered_start("on");
	buffered_run(HOST_S / 10);
	buffered_again();
	buffered_set_out(1, "DS18B20");
	buffered_start("on");
	fleet_run(host.now + HOST_S);
	for (unsigned i = 0; i < host.events; i++)
		notes += strstr(host.event[i].text, "experimental") != NULL;
	TEST_ASSERT_EQUAL_UINT(1, notes);
}

static void look_at_others(const char *chip, bool parasite)
{
	buffered_again();
	buffered_set_out(2, "DS18B20");
	fleet_add(chip, 2);
	fleet.early_ns = 750 * HOST_MS;
	fleet.slave[3]->parasite = parasite;
	buffered_start("on");
	buffered_run_trials(100);
	TEST_ASSERT_EQUAL_UINT_MESSAGE(AHEAD_UNTRIED, buffered_chip(3)->ahead == AHEAD_TRUSTED,
	                               chip);
	TEST_ASSERT_FALSE_MESSAGE(buffered_chip(3)->strict, chip);
	fleet_forget();
	buffered_run_trials(40);
	for (unsigned i = 0; i < 4; i++)
		TEST_ASSERT_GREATER_THAN_UINT_MESSAGE(20, fleet.each[i], chip);
}

static void test_those_that_cannot_take_part_are_read_late(void)
{
	look_at_others("DS18S20", false);
	look_at_others("DS18B20-C", false);
	look_at_others("DS18B20-D2", false);
	look_at_others("DS18B20-B1", false);
}

static void test_with_one_fed_by_the_wire_nothing_is_read_early(void)
{
	look_at_others("DS18B20", true);
	TEST_ASSERT_EQUAL_UINT(0, counted("experimental_early_reads"));
}

/* Asked for only at the beginning: it could be asked for at any time. */
static void look_at_two_channels(int64_t pause_ns)
{
	buffered_again();
	wire_init(&host, 2, 2);
	fleet_add("DS18B20", 30);
	fleet_add_to(1, "DS18B20", 1);
	for (unsigned i = 0; i < fleet.count; i++)
		TEST_ASSERT_EQUAL_INT(0,
		                      fleet.slave[i]->family->option(fleet.slave[i], "spread", 1));
	fleet.pause_ns[30] = pause_ns;
	fleet.early_ns = 170 * HOST_MS;
	buffered_start("on");
	buffered_run(15 * HOST_S);
	TEST_ASSERT_EQUAL_UINT(0, counted("experimental_trials"));
	buffered_trust(590000);
	buffered_run(20 * HOST_S);
	judge_minute();
	TEST_ASSERT_GREATER_THAN_UINT(20 * 30, fleet.good);
	TEST_ASSERT_EQUAL_UINT(0, counted("experimental_early_reads"));
}

static void test_with_thermometers_on_two_channels_nothing_is_read_early(void)
{
	look_at_two_channels(0);
	look_at_two_channels(600 * HOST_S);
}

static void test_one_whose_scratchpad_is_disturbed_falls_back(void)
{
	buffered_set_out(45, "DS18B20");
	fleet.slave[7]->family->option(fleet.slave[7], "upset", 1);
	buffered_start("on");
	buffered_run_trials(440);
	TEST_ASSERT_EQUAL_UINT(AHEAD_REFUSED, buffered_chip(7)->ahead);
	TEST_ASSERT_EQUAL_UINT(AHEAD_TRUSTED, buffered_chip(8)->ahead);
	TEST_ASSERT_EQUAL_UINT(1, counted("experimental_doubts"));
	uint64_t early = counted("experimental_early_reads");
	judge_minute();
	TEST_ASSERT_GREATER_THAN_UINT64(early + 100, counted("experimental_early_reads"));
	TEST_ASSERT_GREATER_THAN_UINT(50, fleet.each[7]);
}

/* It was in order at its trial; an audit finds it. */
static void test_one_that_becomes_disturbed_falls_back_at_the_audit(void)
{
	buffered_set_out(30, "DS18B20");
	buffered_start("on");
	buffered_run(5 * HOST_S);
	buffered_trust(590000);
	buffered_run(30 * HOST_S);
	TEST_ASSERT_EQUAL_UINT(0, counted("experimental_doubts"));
	for (unsigned i = 0; i < fleet.count; i++)
		fleet.slave[i]->family->option(fleet.slave[i], "upset", 1);
	buffered_run(60 * HOST_S);
	TEST_ASSERT_EQUAL_UINT(30, counted("experimental_doubts"));
	fleet_forget();
	uint64_t early = counted("experimental_early_reads");
	buffered_run(60 * HOST_S);
	TEST_ASSERT_EQUAL_UINT(0, fleet.wrong + fleet.failed);
	TEST_ASSERT_EQUAL_UINT64(early, counted("experimental_early_reads"));
}

static void test_a_trial_leaves_settings_and_eeprom_as_they_were(void)
{
	buffered_set_out(1, "DS18B20");
	buffered_start("on");
	buffered_run_trials(40);
	const struct sim_thermometer *s = fleet.slave[0]->state;
	static const uint8_t eeprom[] = {75, 70, 0x7f};

	TEST_ASSERT_EQUAL_UINT(6, counted("experimental_trials"));
	TEST_ASSERT_EQUAL_UINT8_ARRAY(eeprom, s->eeprom, 3);
	TEST_ASSERT_EQUAL_UINT8_ARRAY(eeprom, s->scratchpad + 2, 3);
	TEST_ASSERT_FALSE(s->copying);
}

static void test_after_a_restart_a_chip_is_tried_again(void)
{
	buffered_set_out(2, "DS18B20");
	buffered_start("on");
	buffered_run_trials(40);
	TEST_ASSERT_EQUAL_UINT(12, counted("experimental_trials"));
	sim_slave_brownout(fleet.slave[0], host.now);
	buffered_run_trials(40);
	TEST_ASSERT_EQUAL_UINT(18, counted("experimental_trials"));
	TEST_ASSERT_EQUAL_UINT(0, fleet.wrong);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_fifty_are_new_sooner_than_the_wire_can_read_and_start_them);
	RUN_TEST(test_few_are_new_after_each_conversion);
	RUN_TEST(test_a_value_that_stays_says_by_its_time_when_it_was_certain);
	RUN_TEST(test_what_is_asked_for_with_pauses_converts_no_more_often);
	RUN_TEST(test_nothing_is_tried_without_the_option);
	RUN_TEST(test_the_log_says_once_that_it_is_experimental);
	RUN_TEST(test_those_that_cannot_take_part_are_read_late);
	RUN_TEST(test_with_one_fed_by_the_wire_nothing_is_read_early);
	RUN_TEST(test_with_thermometers_on_two_channels_nothing_is_read_early);
	RUN_TEST(test_one_whose_scratchpad_is_disturbed_falls_back);
	RUN_TEST(test_one_that_becomes_disturbed_falls_back_at_the_audit);
	RUN_TEST(test_a_trial_leaves_settings_and_eeprom_as_they_were);
	RUN_TEST(test_after_a_restart_a_chip_is_tried_again);
	return UNITY_END();
}
