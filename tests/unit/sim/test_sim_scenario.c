/* SPDX-License-Identifier: MIT */
/* Tests of the scenario language of the simulator. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "unity.h"

#include "hal/sim/event.h"
#include "hal/sim/master.h"
#include "hal/sim/scenario.h"
#include "tests/unit/aid/host.h"
#include "tests/unit/aid/parts.h"

#define S INT64_C(1000000000)

static struct sim_net net;
static char why[200];

void setUp(void)
{
	why[0] = '\0';
}

void tearDown(void)
{
	sim_net_clear(&net);
}

static void parse(const char *text)
{
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, sim_scenario_parse("s", text, &net, why, sizeof(why)),
	                              why);
}

static void test_a_wrong_line_is_named_with_its_column(void)
{
	static const struct {
		const char *text, *why;
	} table[] = {
		{"", "s: no chip"},
		{"# nothing\n\n", "s: no chip"},
		{"chip DS2482-200 0x18", "s:1:6: \"DS2482-200\": expected DS2482-100"},
		{"chip DS2482-100 0x17", "s:1:17: 0x17: the I2C address goes from 24 to 31"},
		{"chip DS2482-100", "s:1:16: expected the I2C address"},
		{"chip DS2482-100 0x18 again", "s:1:22: \"again\" is too much here"},
		{"chip DS2482-100 0x18\nchip DS2482-800 0x18", "s:2:17: there is a chip at this"},
		{"chip DS2482-100 0x18\nchannel 1", "s:2:9: 1: the channel goes from 0 to 0"},
		{"DS18B20 28.000000000001", "s:1:1: a device needs a chip before it"},
		{"chip DS2482-100 0x18\n DS18B21 28.000000000001", "s:2:2: \"DS18B21\": expected"},
		{"chip DS2482-100 0x18\nDS18B20 29.000000000001",
	         "s:2:9: a DS18B20 has family code"},
		{"chip DS2482-100 0x18\nDS18B20 28.00000001",
	         "s:2:9: \"28.00000001\": expected a ROM"},
		{"chip DS2482-100 0x18\nDS18B20 28.000000000001.00",
	         "s:2:9: \"28.000000000001.00\": its CRC"},
		{"chip DS2482-100 0x18\nDS18B20 28.000000000001\nDS18B20 28.000000000001",
	         "s:3:9: there is a device 28.000000000001 already"},
		{"chip DS2482-100 0x18\nDS18B20 28.000000000001 as 2x",
	         "s:2:28: \"2x\": expected a name"},
		{"chip DS2482-100 0x18\nDS18B20 28.000000000001 hue 5",
	         "s:2:25: a DS18B20 has no \"hue\""},
		{"chip DS2482-100 0x18\nDS18B20 28.000000000001 resolution 13",
	         "s:2:36: 13 is out of the range of resolution"},
		{"chip DS2482-100 0x18\nDS18B20 28.000000000001 temperature warm",
	         "s:2:37: \"warm\": expected a value"},
		{"chip DS2482-100 0x18\nDS18B20 28.000000000001 temperature sine 5 6",
	         "s:2:45: expected the period"},
		{"chip DS2482-100 0x18\nDS18B20 28.000000000001 temperature sine 5 6 0s",
	         "s:2:46: the period is 1us at least"},
		{"chip DS2482-100 0x18\nDS18B20 28.000000000001 temperature steps 5m:3",
	         "s:2:43: steps begin at 0"},
		{"chip DS2482-100 0x18\nat 5 unplug x", "s:2:4: \"5\": expected a time"},
		{"chip DS2482-100 0x18\nat 5s unplug x", "s:2:14: there is no device \"x\""},
		{"chip DS2482-100 0x18\nat 5s burn 0x18", "s:2:7: \"burn\": expected set, unplug"},
		{"chip DS2482-100 0x18\nat 5s short 0x19",
	         "s:2:13: \"0x19\": expected the address"},
		{"chip DS2482-100 0x18\nat 5s short 0x18.1", "s:2:13: \"0x18.1\": the chip has"},
		{"chip DS2482-100 0x18\nat 5s end reset 0x18", "s:2:11: \"reset\": expected"},
		{"chip DS2482-100 0x18\nat 5s reset 0x18 for 5s",
	         "s:2:18: \"for\" is too much here"},
		{"i2c speed 2000", "s:1:11: 2000: the speed in kHz goes from 10 to 1000"},
		{"i2c combine some", "s:1:13: \"some\": expected any"},
		{"chip DS2482-100 0x18\nDS18B20 28.000000000001 as a\nDS18B20 28.000000000001 as b",
	         "s:3:9: there is a device 28.000000000001 already"},
		{"chip DS2482-800 0x18\nDS2401 01.000000000001 as a\nchannel 3\nDS2401 01.000000000001 as b",
	         "s:4:8: there is a device 01.000000000001 already"},
		{"chip DS2482-100 0x18\nat 5s every 0s short 0x18",
	         "s:2:13: the repetition is 1us at least"},
		{"chip DS2482-100 0x18\nDS18B20 28.000000000001 temperature 128.5",
	         "s:2:37: 128.5: temperature goes from -128 to 127.9375"},
		{"chip DS2482-100 0x18\nDS18B20 28.000000000001 temperature ramp 5 -129 1m",
	         "s:2:44: -129: temperature goes from -128"},
		{"chip DS2482-100 0x18\nDS18B20 28.000000000001 temperature sine 100 29 1m",
	         "s:2:46: 129: temperature goes from -128"},
		{"chip DS2482-100 0x18\nDS18B20 28.000000000001 temperature sine 100 -29 1m",
	         "s:2:46: 129: temperature goes from -128"},
		{"chip DS2482-100 0x18\nDS18B20 28.000000000001 temperature steps 0:5 5s:500",
	         "s:2:47: 500: temperature goes from -128"},
		{"chip DS2482-100 0x18\nDS18B20 28.000000000001 as t\nat 5s set t temperature 129",
	         "s:3:25: 129: temperature goes from -128"},
		{"chip DS2482-100 0x18\nDS18B20 28.000000000001 resolution 8",
	         "s:2:36: 8 is out of the range of resolution"},
		{"chip DS2482-100 0x18\nDS18B20 28.000000000001 resolution 10.5",
	         "s:2:36: 10.5 is out of the range of resolution"},
		{"chip DS2482-100 0x18\nDS2408 29.000000000001 pin.7 2",
	         "s:2:30: 2: pin.7 is 0 or 1"},
		{"chip DS2482-100 0x18\nDS2408 29.000000000001 pin.7 square 0 0.5 1s",
	         "s:2:39: 0.5: pin.7 is 0 or 1"},
		{"chip DS2482-100 0x18\nDS2405 05.000000000001 pin sine 0 1 1s",
	         "s:2:28: \"sine\": pin is 0 or 1"},
		{"chip DS2482-100 0x18\nDS2438 26.000000000001 vdd -1",
	         "s:2:28: -1: vdd goes from 0 to 10"},
		{"chip DS2482-100 0x18\nDS2438 26.000000000001 vdd 10.5",
	         "s:2:28: 10.5: vdd goes from 0 to 10"},
		{"i2c speed 100\n i2c speed 400", "s:2:2: there is an i2c line already"},
	};

	for (unsigned i = 0; i < sizeof(table) / sizeof(table[0]); i++) {
		TEST_ASSERT_EQUAL_INT_MESSAGE(
			-EINVAL, sim_scenario_parse("s", table[i].text, &net, why, sizeof(why)),
			table[i].text);
		why[strlen(table[i].why)] = '\0';
		TEST_ASSERT_EQUAL_STRING(table[i].why, why);
	}
}

static void refuses_file(int err, const char *file, const char *text)
{
	TEST_ASSERT_EQUAL_INT_MESSAGE(err, sim_scenario_read(file, &net, why, sizeof(why)), text);
	TEST_ASSERT_NOT_NULL_MESSAGE(strstr(why, text), why);
}

static void fill_file(const char *file, size_t size, const char *end, size_t end_size)
{
	FILE *stream = fopen(file, "w");

	TEST_ASSERT_NOT_NULL(stream);
	fputs("chip DS2482-100 0x18\n", stream);
	for (size_t i = 21 + end_size; i < size; i++)
		fputc('\n', stream);
	fwrite(end, 1, end_size, stream);
	TEST_ASSERT_EQUAL_INT(0, fclose(stream));
}

static void test_what_is_no_whole_text_file_is_refused(void)
{
	char dir[] = "/tmp/scenario-XXXXXX", file[64], fifo[64];

	TEST_ASSERT_NOT_NULL(mkdtemp(dir));
	snprintf(file, sizeof(file), "%s/a.sim", dir);
	snprintf(fifo, sizeof(fifo), "%s/fifo", dir);
	TEST_ASSERT_EQUAL_INT(0, mkfifo(fifo, 0600));
	refuses_file(-ENOENT, file, "No such file");
	refuses_file(-EINVAL, dir, "not a regular file");
	refuses_file(-EINVAL, fifo, "not a regular file");
	fill_file(file, 1000001, "", 0);
	refuses_file(-EFBIG, file, "longer than 1000000 bytes");
	fill_file(file, 100, "\0\n", 2);
	refuses_file(-EINVAL, file, "zero byte");
	fill_file(file, 1000000, "\nwrong", 6);
	refuses_file(-EINVAL, file, "\"wrong\": expected i2c");
	fill_file(file, 1000000, "", 0);
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, sim_scenario_read(file, &net, why, sizeof(why)), why);
	unlink(file);
	unlink(fifo);
	rmdir(dir);
}

static void test_a_scenario_says_adapter_chips_wires_and_devices(void)
{
	parse("i2c speed 400 combine one-read messages 8 # a comment\r\n"
	      "chip DS2482-800 0x1A times 103\n"
	      "\tchannel 7\n"
	      "\tDS18B20 28.0000000000A1 as boiler parasite resolution 10 temperature 55.5\n"
	      "\tDS2401 01000000000002\n"
	      "chip DS2484 0x18\n"
	      "DS2438 26.000000000003 memory 24 0102ff\n");
	TEST_ASSERT_EQUAL_UINT32(400000, net.hz);
	TEST_ASSERT_EQUAL_INT(SIM_ONE_READ_LAST, net.combine);
	TEST_ASSERT_EQUAL_UINT(8, net.max_messages);
	TEST_ASSERT_EQUAL_UINT(2, net.chips);
	TEST_ASSERT_EQUAL_INT(103, net.chip[0].percent);
	TEST_ASSERT_EQUAL_UINT(2, net.chip[0].wire[7].count);
	TEST_ASSERT_TRUE(sim_net_slave(&net, "boiler")->parasite);
	TEST_ASSERT_EQUAL_DOUBLE(55.5, sim_input_at(sim_net_slave(&net, "boiler"), 0, 0));
	TEST_ASSERT_NOT_NULL(sim_net_slave(&net, "01.000000000002"));
	TEST_ASSERT_EQUAL_UINT(1, net.chip[1].wire[0].count);
}

static void test_curves_are_what_they_say(void)
{
	const struct sim_slave *slave;

	parse("chip DS2482-100 0x18\n"
	      "DS2438 26.000000000001 as a temperature ramp 20 60 10m vdd sine 5 0.5 1h\n"
	      "a vad square 1 2 10s vsens steps 0:1 5s:2 7.5s:-3.5 repeat 10s\n");
	slave = sim_net_slave(&net, "a");
	TEST_ASSERT_EQUAL_DOUBLE(20, sim_input_at(slave, 0, 0));
	TEST_ASSERT_EQUAL_DOUBLE(40, sim_input_at(slave, 0, 300 * S));
	TEST_ASSERT_EQUAL_DOUBLE(60, sim_input_at(slave, 0, 6000 * S));
	TEST_ASSERT_DOUBLE_WITHIN(1e-9, 5.5, sim_input_at(slave, 1, 900 * S));
	TEST_ASSERT_DOUBLE_WITHIN(1e-9, 4.5, sim_input_at(slave, 1, 2700 * S));
	TEST_ASSERT_EQUAL_DOUBLE(1, sim_input_at(slave, 2, 4 * S));
	TEST_ASSERT_EQUAL_DOUBLE(2, sim_input_at(slave, 2, 15 * S));
	TEST_ASSERT_EQUAL_INT64(20 * S, sim_curve_next(&slave->input[2], 15 * S));
	TEST_ASSERT_EQUAL_DOUBLE(1, sim_input_at(slave, 3, 0));
	TEST_ASSERT_EQUAL_DOUBLE(2, sim_input_at(slave, 3, 36 * S));
	TEST_ASSERT_EQUAL_DOUBLE(-3.5, sim_input_at(slave, 3, 38 * S));
	TEST_ASSERT_EQUAL_INT64(37 * S + S / 2, sim_curve_next(&slave->input[3], 36 * S));
	TEST_ASSERT_EQUAL_INT64(40 * S, sim_curve_next(&slave->input[3], 38 * S));
	TEST_ASSERT_EQUAL_UINT64(
		1000000,
		sim_curve_falls(
			&(struct sim_curve){.shape = SIM_SQUARE, .a = 1, .b = 0, .span_ns = S}, 0,
			1000000 * S));
}

static void test_events_happen_at_their_time_again_and_for_as_long_as_they_say(void)
{
	const struct sim_slave *slave;

	parse("chip DS2482-800 0x18\nchannel 2\nDS18B20 28.000000000001 as t temperature 5\n"
	      "at 10s every 1m unplug t for 5s\n"
	      "at 20s set t temperature ramp 5 15 10s\n"
	      "at 1m short 0x18.2 for 1s\n"
	      "at 2d stick 0x18\n");
	slave = sim_net_slave(&net, "t");
	sim_net_run(&net, 1000 * S); /* where the clock starts does not matter */
	TEST_ASSERT_TRUE(slave->plugged);
	TEST_ASSERT_EQUAL_INT64(1010 * S, sim_net_next(&net));
	sim_net_run(&net, 1012 * S);
	TEST_ASSERT_FALSE(slave->plugged);
	sim_net_run(&net, 1016 * S);
	TEST_ASSERT_TRUE(slave->plugged);
	TEST_ASSERT_EQUAL_UINT64(2, slave->power_ons);
	sim_net_run(&net, 1025 * S);
	TEST_ASSERT_EQUAL_DOUBLE(10, sim_input_at(slave, 0, 25 * S));
	sim_net_run(&net, 1000 * S + S * 601 / 10);
	TEST_ASSERT_TRUE(net.chip[0].wire[2].shorted);
	sim_net_run(&net, 1000 * S + 72 * S);
	TEST_ASSERT_FALSE(net.chip[0].wire[2].shorted);
	TEST_ASSERT_FALSE(slave->plugged);
	sim_net_run(&net, 1000 * S + 7 * 86400 * S);
	TEST_ASSERT_EQUAL_INT(SIM_STUCK, net.chip[0].stuck);
	TEST_ASSERT_EQUAL_UINT64(1 + 7 * 1440, slave->power_ons);
}

static void test_of_what_was_due_too_often_in_a_pause_the_last_times_happen(void)
{
	const int64_t us = S / 1000000, slept = 10 * 86400 * S;
	const struct sim_slave *t, *u, *v;

	parse("chip DS2482-100 0x18\nDS18B20 28.000000000001 as t\nDS18B20 28.000000000002 as u\n"
	      "DS18B20 28.000000000003 as v\n"
	      "at 0s every 1us brownout t\n"
	      "at 0s every 10us unplug u for 4us\n"
	      "at 1h short 0x18\n"
	      "at 1us every 1s set v temperature ramp 0 10 10us\n");
	t = sim_net_slave(&net, "t");
	u = sim_net_slave(&net, "u");
	v = sim_net_slave(&net, "v");
	sim_net_run(&net, 0);
	sim_net_run(&net, slept + 2 * us);
	/* a quarter for each of the four that repeat, and at the end all are as they should be */
	TEST_ASSERT_EQUAL_UINT64(2 + SIM_CATCH_UP / 4, t->power_ons);
	TEST_ASSERT_FALSE(u->plugged);
	TEST_ASSERT_EQUAL_UINT64(1 + SIM_CATCH_UP / 4, u->power_ons);
	TEST_ASSERT_TRUE(net.chip[0].wire[0].shorted);
	TEST_ASSERT_EQUAL_DOUBLE(1, sim_input_at(v, 0, slept + 2 * us));
	sim_net_run(&net, slept + 5 * us);
	TEST_ASSERT_TRUE(u->plugged);
	TEST_ASSERT_EQUAL_UINT64(2 + SIM_CATCH_UP / 4 + 3, t->power_ons);
	TEST_ASSERT_EQUAL_INT64(slept + 6 * us, sim_net_next(&net));
	/* up to there none is left out, in one call as in many */
	sim_net_run(&net, slept + 5 * us + S / 50);
	TEST_ASSERT_EQUAL_UINT64(2 + SIM_CATCH_UP / 4 + 3 + 20000, t->power_ons);
}

static void test_an_event_can_be_made_to_happen_now(void)
{
	parse("chip DS2482-100 0x18\nDS18B20 28.000000000001 as t");
	TEST_ASSERT_EQUAL_INT(0,
	                      sim_scenario_event(&net, "unplug t for 2s", 5 * S, why, sizeof(why)));
	TEST_ASSERT_FALSE(sim_net_slave(&net, "t")->plugged);
	sim_net_run(&net, 8 * S);
	TEST_ASSERT_TRUE(sim_net_slave(&net, "t")->plugged);
	TEST_ASSERT_EQUAL_INT(-EINVAL,
	                      sim_scenario_event(&net, "unplug u", 8 * S, why, sizeof(why)));
	TEST_ASSERT_NOT_NULL(strstr(why, "there is no device"));
	TEST_ASSERT_EQUAL_INT(0, sim_scenario_event(&net, "corrupt t chance 0.5 seed 7", 9 * S, why,
	                                            sizeof(why)));
	TEST_ASSERT_EQUAL_DOUBLE(0.5, sim_net_slave(&net, "t")->corrupt_probability);
	TEST_ASSERT_EQUAL_INT(0,
	                      sim_scenario_event(&net, "end corrupt t", 9 * S, why, sizeof(why)));
	TEST_ASSERT_EQUAL_DOUBLE(0, sim_net_slave(&net, "t")->corrupt_probability);
}

static void test_random_text_is_refused_or_taken_but_never_crashes(void)
{
	static const char *const words[] = {
		"i2c",
		"speed",
		"combine",
		"any",
		"chip",
		"DS2482-800",
		"DS2484",
		"0x18",
		"0x1f",
		"channel",
		"3",
		"DS18B20",
		"28.000000000001",
		"as",
		"t",
		"temperature",
		"sine",
		"ramp",
		"steps",
		"0:5",
		"5s:6",
		"repeat",
		"10s",
		"at",
		"every",
		"1m",
		"unplug",
		"short",
		"0x18.2",
		"for",
		"-5",
		"1e9",
		"memory",
		"0011",
		"#",
		"\n",
		"\n",
		"\n",
		"DS2438",
		"26.000000000001",
		"DS2408",
		"29.000000000001",
		"pin.0",
		"parasite",
		"end",
		"button",
		"short",
	};
	uint32_t seed = 20260101;
	char text[2000], message[40];

	for (unsigned round = 0; round < 3000; round++) {
		size_t used = 0;
		int err;

		snprintf(message, sizeof(message), "round %u", round);
		for (unsigned n = 0; n < 60; n++) {
			seed = seed * 1664525 + 1013904223;
			used += (size_t)snprintf(
				text + used, sizeof(text) - used, "%s ",
				words[(seed >> 8) % (sizeof(words) / sizeof(words[0]))]);
		}
		err = sim_scenario_parse("s", text, &net, why, sizeof(why));
		TEST_ASSERT_TRUE_MESSAGE(err == 0 || (err == -EINVAL && *why), message);
		sim_net_clear(&net);
	}
}

static void test_the_target_sim_opens_the_house_of_the_demonstration(void)
{
	static struct host host;
	struct link_master *master;
	struct link *link;

	host_init_virtual(&host);
	TEST_ASSERT_EQUAL_INT_MESSAGE(
		0, sim_master.create("board/demo/house.sim", &host.env, &master, why, sizeof(why)),
		why);
	TEST_ASSERT_TRUE(master->ops->simulated);
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, master->ops->open(master, why, sizeof(why)), why);
	link = master->ops->channel(master, 0);
	TEST_ASSERT_EQUAL_INT(1, part_reset(link));
	TEST_ASSERT_NOT_NULL(sim_net_slave(sim_master_net(master), "boiler"));
	master->ops->destroy(master);
	TEST_ASSERT_EQUAL_INT(-EINVAL, sim_master.create("no-such-file:0x18", &host.env, &master,
	                                                 why, sizeof(why)));
	TEST_ASSERT_NOT_NULL(strstr(why, "no-such-file:"));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_wrong_line_is_named_with_its_column);
	RUN_TEST(test_what_is_no_whole_text_file_is_refused);
	RUN_TEST(test_a_scenario_says_adapter_chips_wires_and_devices);
	RUN_TEST(test_curves_are_what_they_say);
	RUN_TEST(test_events_happen_at_their_time_again_and_for_as_long_as_they_say);
	RUN_TEST(test_of_what_was_due_too_often_in_a_pause_the_last_times_happen);
	RUN_TEST(test_an_event_can_be_made_to_happen_now);
	RUN_TEST(test_random_text_is_refused_or_taken_but_never_crashes);
	RUN_TEST(test_the_target_sim_opens_the_house_of_the_demonstration);
	return UNITY_END();
}
