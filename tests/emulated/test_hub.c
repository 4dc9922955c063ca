/* SPDX-License-Identifier: MIT */
/*
 * owsd on the chips that OneWireHub plays, its own classes behind the simulator's wire: no value is
 * false, no command counts that is not in force, quiet and under noise.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "unity.h"

#include "tests/emulated/hub.h"
#include "tests/unit/aid/one_slave.h"

static struct trouble trouble;

void setUp(void)
{
	srand(1);
	one_slave_begin();
}

void tearDown(void)
{
	wire_net.trouble = NULL;
	one_slave_end();
}

/* Plug it in, and read until it is known for what it is. */
static void plug(const char *chip, const char *property)
{
	const struct bus_answer *a = NULL;

	wire_init(&host, 1, 1);
	slave = wire_add(0, chip, 1);
	bus = wire_open();
	TEST_ASSERT_TRUE(host_run_events(&host, bus, 1, host.now + HOST_S));
	hub_slots = 0;
	for (unsigned i = 0; i < 8; i++)
		a = go(BUS_READ, property, NULL);
	TEST_ASSERT_EQUAL_INT(0, a->err);
	TEST_ASSERT_NOT_NULL_MESSAGE(strstr(a->identity, "emulated"), a->identity);
	TEST_ASSERT_GREATER_THAN_UINT(64, hub_slots);
}

static void noise(double probability)
{
	trouble_none(&trouble);
	trouble.kind = TROUBLE_NOISE;
	trouble.probability = probability;
	trouble.random = (uint64_t)rand() + 1;
	wire_net.trouble = probability > 0 ? &trouble : NULL;
}

static double between(double least, double most)
{
	return least + (most - least) * (rand() / (double)RAND_MAX);
}

static const struct {
	const char *input, *property;
	double least, most, scale, slack;
} measured[] = {
	{"temperature", "temperature", -55, 125, 1, 0.05},
	{"vdd", "VDD", 2.1, 10, 1, 0.0101},
	{"vad", "VAD", 0, 10, 1, 0.0101},
	{"vsens", "vis", -240, 240, 0.001, 0.00026},
};

#define ROUNDS 2000
static double set[ROUNDS][4];

/* The voltage of an earlier round: the program did not hear Convert V, and nothing shows that. */
static bool is_earlier(unsigned round, unsigned n, double number)
{
	if (strcmp(measured[n].property, "VDD") && strcmp(measured[n].property, "VAD"))
		return false;
	for (unsigned i = 0; i < round; i++)
		if (fabs(number - set[i][n] * measured[n].scale) <= measured[n].slack)
			return true;
	return false;
}

/* Returns how many of the readings have no value. */
static unsigned monitor(double probability)
{
	unsigned without = 0, earlier = 0;

	plug("DS2438-EMULATED", "temperature");
	noise(probability);
	for (unsigned i = 0; i < ROUNDS; i++) {
		unsigned n = (unsigned)rand() % 4;

		for (unsigned k = 0; k < 4; k++) {
			set[i][k] = between(measured[k].least, measured[k].most);
			wire_set(slave, measured[k].input, set[i][k]);
		}
		const struct bus_answer *a = go(BUS_READ, measured[n].property, NULL);
		double is = set[i][n] * measured[n].scale;
		if (a->err)
			without++;
		else if (fabs(a->number - is) > measured[n].slack) {
			TEST_ASSERT_TRUE_MESSAGE(is_earlier(i, n, a->number), measured[n].property);
			earlier++;
		}
	}
	TEST_ASSERT_LESS_THAN_UINT_MESSAGE(probability > 0 ? ROUNDS / 100 : 1, earlier,
	                                   "values of earlier rounds");
	wire_net.trouble = NULL;
	for (unsigned i = 0; i < 20; i++)
		TEST_ASSERT_EQUAL_INT(0, go(BUS_READ, i & 1 ? "VAD" : "temperature", NULL)->err);
	return without;
}

static void test_a_monitor_reads_what_the_sketch_has_set(void)
{
	TEST_ASSERT_EQUAL_UINT(0, monitor(0));
}

static void test_noise_makes_no_false_value_of_a_monitor(void)
{
	unsigned without = monitor(0.003);

	TEST_ASSERT_GREATER_THAN_UINT_MESSAGE(0, without, "there was no noise");
	TEST_ASSERT_LESS_THAN_UINT(ROUNDS, without);
}

static void test_pages_are_written_as_they_are_read(void)
{
	plug("DS2438-EMULATED", "temperature");
	for (unsigned round = 0; round < 100; round++) {
		unsigned page = 2 + (unsigned)rand() % 6;
		char name[20], text[9] = {0};

		for (int i = 0; i < 8; i++)
			text[i] = (char)('!' + rand() % 90);
		snprintf(name, sizeof(name), "pages/page.%u", page);
		writes(name, text);
		TEST_ASSERT_EQUAL_MEMORY(text, hub_memory(hub_of(slave)) + page * 8, 8);
		reads(name, text);
	}
}

/* Which chip it is, is found out without a trace in its memory. */
static void test_the_recognition_changes_nothing(void)
{
	static const char *const first[] = {"temperature",  "VDD",       "VAD", "vis",
	                                    "pages/page.3", "offset",    "IAD", "CA",
	                                    "latesttemp",   "latestvolt"};

	for (unsigned i = 0; i < sizeof(first) / sizeof(*first); i++) {
		uint8_t before[64];

		tearDown();
		setUp();
		wire_init(&host, 1, 1);
		slave = wire_add(0, "DS2438-EMULATED", 1);
		bus = wire_open();
		TEST_ASSERT_TRUE(host_run_events(&host, bus, 1, host.now + HOST_S));
		memcpy(before, hub_memory(hub_of(slave)), sizeof(before));
		for (unsigned k = 0; k < 6; k++)
			go(BUS_READ, first[i], NULL);
		/* byte 0 has the flags of what is measured, 1 to 6 what was */
		TEST_ASSERT_EQUAL_MEMORY_MESSAGE(before + 7, hub_memory(hub_of(slave)) + 7, 57,
		                                 first[i]);
	}
}

static void switches(double probability, unsigned rounds)
{
	plug("DS2413-EMULATED", "sensed.BYTE");
	for (unsigned i = 0; i < rounds; i++) {
		unsigned pins = (unsigned)rand() & 3, wanted = (unsigned)rand() & 3, now;
		char text[2] = {(char)('0' + wanted), '\0'};

		wire_set(slave, "pin.A", pins & 1);
		wire_set(slave, "pin.B", pins >> 1);
		noise(probability);
		bool written = !go(BUS_WRITE, "PIO.BYTE", text)->err;
		wire_net.trouble = NULL;
		const struct bus_answer *a = go(BUS_READ, "PIO.BYTE", NULL);
		TEST_ASSERT_EQUAL_INT(0, a->err);
		now = (unsigned)a->number;
		if (written)
			TEST_ASSERT_EQUAL_UINT_MESSAGE(wanted, now, "a write that is not in force");
		else
			TEST_ASSERT_TRUE(probability > 0);
		noise(probability);
		a = go(BUS_READ, "sensed.BYTE", NULL);
		wire_net.trouble = NULL;
		if (!a->err)
			TEST_ASSERT_EQUAL_UINT(pins & ~now, (unsigned)a->number);
	}
}

static void test_a_switch_does_what_was_written(void)
{
	switches(0, 500);
}

static void test_noise_makes_no_false_word_of_a_switch(void)
{
	switches(0.002, 3000);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_monitor_reads_what_the_sketch_has_set);
	RUN_TEST(test_noise_makes_no_false_value_of_a_monitor);
	RUN_TEST(test_pages_are_written_as_they_are_read);
	RUN_TEST(test_the_recognition_changes_nothing);
	RUN_TEST(test_a_switch_does_what_was_written);
	RUN_TEST(test_noise_makes_no_false_word_of_a_switch);
	return UNITY_END();
}
