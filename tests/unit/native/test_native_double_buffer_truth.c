/* SPDX-License-Identifier: MIT */
/*
 * The experimental double buffer: no trouble, no lost command and no restart makes an old result
 * look new, nor changes the settings of a chip in its trial.
 */
#include <stdio.h>
#include <string.h>

#include "hal/native/state.h"
#include "hal/sim/chips/thermometer.h"
#include "unity.h"

#include "tests/unit/aid/buffered.h"

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

/* Enough that some are read early: else there is no gain. */
static void set_up(unsigned count, const char *chip)
{
	buffered_again();
	buffered_set_out(count, chip);
	wire_net.trouble = &trouble;
	trouble.random = 20253;
	trouble_none(&trouble);
	buffered_start("on");
	buffered_run(3 * HOST_S);
	buffered_trust(590000);
	buffered_run(4 * HOST_S);
	fleet_forget();
	trouble_none(&trouble);
}

static void two(void)
{
	set_up(2, "DS18B20");
}

/* Each slot and each reset of more than a cycle of two. */
static void test_no_trouble_in_any_slot_makes_an_old_result_look_new(void)
{
	uint32_t slots;
	unsigned good = fleet_troubles(&trouble, two, buffered_run, 900 * HOST_MS, &slots);

	TEST_ASSERT_GREATER_OR_EQUAL_UINT32(2 * 152, slots);
	TEST_ASSERT_GREATER_THAN_UINT(2 * 4 * slots, good);
}

static void test_no_restart_at_any_moment_makes_an_old_result_look_new(void)
{
	static const char *const chips[] = {"DS18B20", "DS1822", "DS18B20-A2", "DS18B20-H"};
	unsigned wrong = 0, good = 0;

	for (unsigned c = 0; c < 4; c++)
		for (int64_t at = 1; at < 1600; at += 7) {
			set_up(4, chips[c]);
			trouble.kind = TROUBLE_RESTART;
			trouble.restart_ns = host.now + at * HOST_MS;
			buffered_run(5 * HOST_S);
			wrong += fleet.wrong;
			good += fleet.good;
		}
	TEST_ASSERT_EQUAL_UINT(0, wrong);
	TEST_ASSERT_GREATER_THAN_UINT(3000, good);
}

static unsigned deaf, deaf_for;

/* The first of them does not hear that Convert T for all. */
static void miss_convert(const uint8_t *bytes, size_t n)
{
	if (n != 2 || bytes[0] != 0xcc || bytes[1] != 0x44 || !deaf)
		return;
	for (unsigned i = 0; i < deaf_for; i++) {
		fleet.slave[i]->busy = false;
		sim_end(fleet.slave[i]);
	}
	deaf--;
}

static void test_one_that_misses_commands_for_all_gives_no_old_result_as_new(void)
{
	for (unsigned missed = 1; missed < 40; missed += missed < 3 ? 1 : 17)
		for (unsigned who = 1; who <= 20; who += 19) {
			set_up(45, "DS18B20");
			/* Behind a jump: values with old stamps are judged, too. */
			buffered_run(64 * HOST_S - host.now % (60 * HOST_S));
			fleet_forget();
			uint64_t early = counted("experimental_early_reads");
			wire_net.sent = miss_convert;
			deaf = missed;
			deaf_for = who;
			buffered_run(50 * HOST_S);
			wire_net.sent = NULL;
			TEST_ASSERT_EQUAL_UINT(0, deaf);
			TEST_ASSERT_EQUAL_UINT(0, fleet.wrong);
			TEST_ASSERT_GREATER_THAN_UINT64(early + 100,
			                                counted("experimental_early_reads"));
			fleet_forget();
			buffered_run(20 * HOST_S);
			TEST_ASSERT_EQUAL_UINT(0, fleet.wrong + fleet.failed);
			TEST_ASSERT_GREATER_THAN_UINT(10, fleet.each[0]);
		}
}

/* What it is read for the first time after two conversions may be of either. */
static void test_one_that_is_asked_for_rarely_gives_no_old_result_as_new(void)
{
	unsigned stood = 0;

	for (unsigned i = 0; i < 20; i++) {
		set_up(45, "DS18B20");
		buffered_run(64 * HOST_S - host.now % (60 * HOST_S));
		fleet_forget();
		fleet.pause_ns[0] = (700 + 74 * i) * HOST_MS;
		wire_net.sent = miss_convert;
		deaf_for = 1;
		for (unsigned k = 0; k < 12; k++) {
			int64_t stamp = buffered_chip(0)->latched_ns;

			deaf = 1;
			buffered_run(2300 * HOST_MS);
			stood += buffered_chip(0)->latched_ns == stamp;
		}
		wire_net.sent = NULL;
		TEST_ASSERT_EQUAL_UINT(0, fleet.wrong);
	}
	TEST_ASSERT_GREATER_THAN_UINT(10, stood);
}

static void test_one_that_loses_its_supply_gives_no_old_result(void)
{
	unsigned wrong = 0;

	for (int64_t at = 1; at < 800; at += 23) {
		set_up(20, "DS18B20");
		buffered_run(at * HOST_MS);
		fleet_forget();
		fleet.slave[2]->parasite = true;
		buffered_run(20 * HOST_S);
		wrong += fleet.wrong;
		TEST_ASSERT_GREATER_THAN_UINT(5, fleet.each[0]);
	}
	TEST_ASSERT_EQUAL_UINT(0, wrong);
}

/* Requests end with an error, and go on when the wire is back. */
static void test_a_wire_that_is_cut_and_mended_goes_on(void)
{
	for (int64_t at = 1; at < 900; at += 47) {
		set_up(45, "DS18B20");
		buffered_run(at * HOST_MS);
		fleet_forget();
		for (unsigned i = 0; i < fleet.count; i++)
			fleet.slave[i]->plugged = false;
		buffered_run(12 * HOST_S);
		TEST_ASSERT_GREATER_THAN_UINT(45, fleet.failed);
		for (unsigned i = 0; i < fleet.count; i++) {
			fleet.slave[i]->plugged = true;
			sim_slave_power_on(fleet.slave[i], host.now);
		}
		buffered_run(12 * HOST_S);
		TEST_ASSERT_EQUAL_UINT(0, fleet.wrong);
		fleet_forget();
		buffered_run(12 * HOST_S);
		for (unsigned i = 0; i < fleet.count; i++)
			TEST_ASSERT_GREATER_THAN_UINT(2, fleet.each[i]);
	}
}

/* A reading of all, a command for all or another resolution comes between at any moment. */
static void test_other_requests_between_make_no_old_result_look_new(void)
{
	static const struct {
		enum bus_op op;
		const char *what;
	} kinds[] = {
		{BUS_WRITE, "/simultaneous/temperature"},
		{BUS_READ, "temperature9"},
		{BUS_READ, "latesttemp"},
		{BUS_READ, "power"},
	};
	for (unsigned k = 0; k < 4; k++)
		for (int64_t at = 1; at < 900; at += 31) {
			int err;

			set_up(6, "DS18B20");
			/* Another resolution has its turn when nobody asks for this one. */
			fleet.pause_ns[3] = 1500 * HOST_MS;
			buffered_run(at * HOST_MS);
			const char *what = kinds[k].what[0] == '/'
			                           ? kinds[k].what
			                           : of(fleet.slave[3], kinds[k].what);
			fleet_answered(fleet_ask(BUS_INPUT, kinds[k].op, what), &err);
			buffered_run(6 * HOST_S);
			TEST_ASSERT_EQUAL_UINT_MESSAGE(0, fleet.wrong, kinds[k].what);
			TEST_ASSERT_GREATER_THAN_UINT_MESSAGE(20, fleet.good, kinds[k].what);
		}
}

static void test_noise_makes_no_old_result_look_new(void)
{
	set_up(45, "DS18B20");
	trouble.kind = TROUBLE_NOISE;
	trouble.probability = 0.001;
	for (unsigned i = 0; i < 60; i++) {
		buffered_run(20 * HOST_S);
		buffered_trust(590000);
	}
	TEST_ASSERT_EQUAL_UINT(0, fleet.wrong);
	TEST_ASSERT_GREATER_THAN_UINT(10000, fleet.good);
	TEST_ASSERT_GREATER_THAN_UINT64(1000, counted("experimental_early_reads"));
}

static void test_noise_during_the_trials_refuses_no_chip_and_trusts_none_wrongly(void)
{
	buffered_set_out(6, "DS18B20");
	fleet.slave[5]->family->option(fleet.slave[5], "upset", 1);
	wire_net.trouble = &trouble;
	trouble.random = 20254;
	trouble_none(&trouble);
	buffered_start("on");
	trouble.kind = TROUBLE_NOISE;
	trouble.probability = 0.0003;
	buffered_run_trials(400);
	TEST_ASSERT_EQUAL_UINT(0, fleet.wrong);
	TEST_ASSERT_NOT_EQUAL(AHEAD_TRUSTED, buffered_chip(5)->ahead);
	for (unsigned i = 0; i < 5; i++)
		TEST_ASSERT_NOT_EQUAL(AHEAD_REFUSED, buffered_chip(i)->ahead);
}

/* Each slot of a part of the trial, turned over, and each command lost. */
static void test_no_trouble_in_a_trial_leaves_other_settings(void)
{
	static const uint8_t settings[] = {75, 70, 0x7f};
	uint32_t slots = 1;

	for (uint32_t at = 0; at < slots; at++) {
		buffered_again();
		buffered_set_out(1, "DS18B20");
		wire_net.trouble = &trouble;
		trouble_none(&trouble);
		buffered_start("on");
		struct native *native = (struct native *)bus;
		while (!native->trial.device)
			fleet_run(host.now + HOST_MS);
		trouble_none(&trouble);
		trouble.kind = at % 2 ? TROUBLE_DEAF : at ? TROUBLE_TURN : TROUBLE_NONE;
		trouble.mask = 1;
		trouble.at = at;
		while (native->trial.device)
			fleet_run(host.now + HOST_MS);
		slots = at ? slots : trouble.slots;
		buffered_run(3 * HOST_S);
		const struct sim_thermometer *s = fleet.slave[0]->state;
		TEST_ASSERT_EQUAL_UINT8_ARRAY(settings, s->scratchpad + 2, 2);
		TEST_ASSERT_EQUAL_UINT8_ARRAY(settings, s->eeprom, 3);
		TEST_ASSERT_EQUAL_UINT(0, fleet.wrong);
		TEST_ASSERT_EQUAL_UINT(0, counted("experimental_doubts"));
	}
	TEST_ASSERT_GREATER_THAN_UINT(1000, slots);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_no_trouble_in_any_slot_makes_an_old_result_look_new);
	RUN_TEST(test_no_restart_at_any_moment_makes_an_old_result_look_new);
	RUN_TEST(test_one_that_misses_commands_for_all_gives_no_old_result_as_new);
	RUN_TEST(test_one_that_is_asked_for_rarely_gives_no_old_result_as_new);
	RUN_TEST(test_one_that_loses_its_supply_gives_no_old_result);
	RUN_TEST(test_a_wire_that_is_cut_and_mended_goes_on);
	RUN_TEST(test_other_requests_between_make_no_old_result_look_new);
	RUN_TEST(test_noise_makes_no_old_result_look_new);
	RUN_TEST(test_noise_during_the_trials_refuses_no_chip_and_trusts_none_wrongly);
	RUN_TEST(test_no_trouble_in_a_trial_leaves_other_settings);
	return UNITY_END();
}
