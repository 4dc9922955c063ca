/* SPDX-License-Identifier: MIT */
/*
 * Conversions that end before their longest time are read earlier, and no trouble at the question
 * makes an old result look new. The chips here take four fifths of the longest time.
 */
#include <errno.h>
#include <stdio.h>

#include "unity.h"

#include "tests/unit/aid/fleet.h"

#define READ_NS (1184000 + 19 * 8 * INT64_C(69250))

static struct trouble trouble;

void setUp(void)
{
	native_begin();
	fleet_begin();
}

void tearDown(void)
{
	native_end();
}

static void set_out(unsigned count, const char *chip)
{
	wire_init(&host, 1, 1);
	fleet_add(chip, count);
	fleet.early_ns = 170 * HOST_MS;
	for (unsigned i = 0; i < count; i++)
		TEST_ASSERT_EQUAL_INT(0, sim_slave_option(fleet.slave[i], "speed", 80));
}

/* The mean time in which the value of the one is new, in ms. */
static double new_each(void)
{
	start();
	fleet_run(host.now + 5 * HOST_S);
	fleet_forget();
	fleet_run(host.now + 60 * HOST_S);
	TEST_ASSERT_EQUAL_UINT(0, fleet.wrong + fleet.older + fleet.newer + fleet.failed);
	char text[60];
	snprintf(text, sizeof(text), "new each %.0f ms", 54000.0 / fleet.good);
	TEST_MESSAGE(text);
	return 54000.0 / fleet.good;
}

/* 600 ms and a reading; the searches in the background prevent some of the questions. */
static void test_a_value_that_changes_is_read_when_the_chip_is_ready(void)
{
	set_out(1, "DS18B20");
	TEST_ASSERT_TRUE(new_each() < 680);
}

/* The end is seen, but nothing shows that the chip has converted. */
static void test_a_value_that_stays_is_read_when_the_longest_time_is_over(void)
{
	fleet_slope = 1e-6;
	set_out(1, "DS18B20");
	double ms = new_each();

	TEST_ASSERT_TRUE(ms > 750);
	TEST_ASSERT_TRUE(ms < 785);
}

/* Its conversion is over after 160 ms, but 750 ms is what all of its family code are given. */
static void test_a_max31825_whose_value_stays_is_read_when_the_longest_time_is_over(void)
{
	fleet_slope = 1e-6;
	wire_init(&host, 1, 1);
	fleet_add("MAX31825", 1);
	fleet.early_ns = 600 * HOST_MS;
	TEST_ASSERT_TRUE(new_each() > 750);
}

/* All asked for in one go; the first scans prove what the chips show. */
static int64_t scan(unsigned count)
{
	uint32_t id[FLEET_MAX];
	int64_t begun = host.now;

	for (unsigned i = 0; i < count; i++)
		id[i] = ask(BUS_READ, BUS_INPUT, true, of(fleet.slave[i], "temperature"), NULL);
	for (unsigned i = 0; i < count; i++)
		TEST_ASSERT_EQUAL_INT(0, answer_to(id[i])->err);
	forget();
	return host.now - begun;
}

static int64_t quickest_scan(unsigned count, double step)
{
	int64_t quickest = INT64_MAX;

	set_out(count, "DS18B20");
	start();
	for (unsigned i = 0; i < 100; i++) {
		for (unsigned k = 0; k < count; k++)
			wire_set(fleet.slave[k], "temperature", 20 + step * i + k);
		int64_t took = scan(count);
		host_run(&host, bus, host.now + 137 * HOST_MS);
		quickest = took < quickest ? took : quickest;
		/* The first scan asks for supplies too; each minute one asks one by one. */
		if (i > 2 && took < 1000 * HOST_MS)
			TEST_ASSERT_LESS_THAN_INT64(790 * HOST_MS + (int)count * READ_NS, took);
	}
	return quickest;
}

static void test_a_scan_of_ten_is_over_when_all_were_ready(void)
{
	int64_t took = quickest_scan(10, 0.5);

	TEST_ASSERT_LESS_THAN_INT64(620 * HOST_MS + 10 * READ_NS, took);
	TEST_ASSERT_GREATER_THAN_INT64(600 * HOST_MS + 10 * READ_NS, took);
}

static void test_a_scan_of_ten_that_did_not_change_takes_the_longest_time(void)
{
	TEST_ASSERT_GREATER_THAN_INT64(750 * HOST_MS, quickest_scan(10, 0));
}

/* The first reads what proves nothing, and its deadline ends while it waits. */
static void test_who_reads_after_another_gave_up_needs_the_proof_too(void)
{
	set_out(1, "DS18B20");
	wire_set(fleet.slave[0], "temperature", 20);
	start();
	for (unsigned i = 0; i < 4; i++) {
		scan(1);
		host_run(&host, bus, host.now + 137 * HOST_MS);
	}
	int64_t begun = host.now;
	const char *what = of(fleet.slave[0], "temperature");
	uint32_t first = ask(BUS_READ, BUS_INPUT, true, what, NULL);
	uint32_t second = ask(BUS_READ, BUS_INPUT, true, what, NULL);

	req[first].deadline_ns = begun + 690 * HOST_MS;
	TEST_ASSERT_EQUAL_INT(-EINPROGRESS, answer_to(first)->err);
	TEST_ASSERT_EQUAL_INT(0, answer_to(second)->err);
	TEST_ASSERT_GREATER_THAN_INT64(750 * HOST_MS, host.now - begun);
}

/* The second is asked for so rarely that what it held before a conversion was not read. */
static void test_no_trouble_at_the_question_makes_an_old_result_look_new(void)
{
	static const enum trouble_kind kinds[] = {TROUBLE_TURN, TROUBLE_DEAF, TROUBLE_ABSENT,
	                                          TROUBLE_FALSE};
	unsigned wrong = 0, good = 0, places = 0;

	for (unsigned k = 0; k < sizeof(kinds) / sizeof(kinds[0]); k++) {
		bool of_resets = kinds[k] == TROUBLE_ABSENT || kinds[k] == TROUBLE_FALSE;

		for (uint32_t at = 0, last = 1; at <= last; at++, places++) {
			fleet_again();
			set_out(2, "DS18B20");
			wire_net.trouble = &trouble;
			trouble_none(&trouble);
			fleet.pause_ns[1] = 2300 * HOST_MS;
			start();
			fleet_run(host.now + 70 * HOST_S);
			fleet_forget();
			trouble_none(&trouble);
			trouble.kind = kinds[k];
			trouble.mask = 1;
			trouble.at = at;
			fleet_run(host.now + 2 * HOST_S);
			last = of_resets ? trouble.resets : trouble.slots;
			fleet_run(host.now + 2 * HOST_S);
			wrong += fleet.wrong;
			good += fleet.good;
		}
	}
	TEST_ASSERT_EQUAL_UINT(0, wrong);
	TEST_ASSERT_GREATER_THAN_UINT(1000, places);
	TEST_ASSERT_GREATER_THAN_UINT(4 * places, good);
}

static void test_no_restart_makes_an_old_result_look_new(void)
{
	static const char *const chips[] = {"DS18B20", "DS18S20", "DS1822", "DS18B20-B1"};
	unsigned good = 0;

	for (unsigned c = 0; c < 4; c++)
		good += fleet_restarts(set_out, 1, chips[c], 4 * HOST_S, 1400, 9);
	TEST_ASSERT_GREATER_THAN_UINT(2000, good);
}

static void test_noise_makes_no_old_result_look_new(void)
{
	set_out(2, "DS18B20");
	wire_net.trouble = &trouble;
	trouble.random = 20252;
	trouble_none(&trouble);
	fleet.pause_ns[1] = 2300 * HOST_MS;
	start();
	fleet_run(host.now + 70 * HOST_S);
	fleet_forget();
	trouble.kind = TROUBLE_NOISE;
	trouble.probability = 0.001;
	for (unsigned i = 0; i < 180; i++) {
		fleet_run(host.now + 20 * HOST_S);
		host.events = 0;
	}
	TEST_ASSERT_EQUAL_UINT(0, fleet.wrong);
	TEST_ASSERT_GREATER_THAN_UINT(1000, fleet.good);
}

/* --- Two channels of one chip ----------------------------------------------------------------- */

static unsigned cut;

/* Any use of the chip ends the strong pull-up of each of its channels. */
static void look_at_pull_up(int64_t now)
{
	for (unsigned n = 0; n < 2; n++)
		cut += wire_net.wire[n].strong && fleet.slave[n]->busy &&
		       now < fleet.slave[n]->until;
}

static void test_no_question_cuts_the_strong_pull_up_of_another_channel(void)
{
	cut = 0;
	wire_init(&host, 2, 1);
	wire_net.used = look_at_pull_up;
	fleet_add_to(0, "DS18B20", 1);
	fleet_add_to(1, "DS18B20", 1);
	fleet.slave[1]->parasite = true;
	fleet.early_ns = 170 * HOST_MS;
	fleet.pause_ns[0] = 130 * HOST_MS;
	fleet.pause_ns[1] = 470 * HOST_MS;
	start();
	fleet_run(host.now + 60 * HOST_S);
	TEST_ASSERT_EQUAL_UINT(0, cut);
	TEST_ASSERT_GREATER_THAN_UINT(20, wire_net.strong_count);
	TEST_ASSERT_GREATER_THAN_UINT(20, fleet.each[0]);
	TEST_ASSERT_GREATER_THAN_UINT(20, fleet.each[1]);
	TEST_ASSERT_EQUAL_UINT(0, fleet.wrong + fleet.failed);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_value_that_changes_is_read_when_the_chip_is_ready);
	RUN_TEST(test_a_value_that_stays_is_read_when_the_longest_time_is_over);
	RUN_TEST(test_a_scan_of_ten_is_over_when_all_were_ready);
	RUN_TEST(test_a_scan_of_ten_that_did_not_change_takes_the_longest_time);
	RUN_TEST(test_who_reads_after_another_gave_up_needs_the_proof_too);
	RUN_TEST(test_a_max31825_whose_value_stays_is_read_when_the_longest_time_is_over);
	RUN_TEST(test_no_trouble_at_the_question_makes_an_old_result_look_new);
	RUN_TEST(test_no_restart_makes_an_old_result_look_new);
	RUN_TEST(test_noise_makes_no_old_result_look_new);
	RUN_TEST(test_no_question_cuts_the_strong_pull_up_of_another_channel);
	return UNITY_END();
}
