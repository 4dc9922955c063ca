/* SPDX-License-Identifier: MIT */
/*
 * Thermometers on several DS2482 of one I2C bus that are asked for without pause: how often each
 * value is new, whose it is, what others wait, and what trouble of one chip does to the others.
 */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "unity.h"

#include "hal/native/convert/schedule.h"
#include "hal/sim/event.h"
#include "tests/unit/aid/host.h"
#include "tests/unit/aid/plant.h"

#define CHIPS 4
#define EACH 10
#define COUNT (CHIPS * EACH)
#define OTHER COUNT
/* A reading of one chip, or of several at the same time: what an urgent request waits at most. */
#define GROUP_NS (22 * HOST_MS)

static struct host host;
static struct bus *bus;
static struct sim_net *net;
static struct bus_req req[COUNT + 1];
static char path[COUNT + 1][64];
static uint8_t data[COUNT + 1][64];
static bool is_asked[COUNT + 1];
static int64_t asked_ns[COUNT + 1], took_ns, again_ns[COUNT];
static double set_to[COUNT];
static unsigned turn, good[COUNT], wrong, old, failed, failed_of[CHIPS];
static int last_err;
static unsigned mute; /* this one is a clone that shows no conversion */

/* Steps of a sixteenth, all of them different for a long time. */
static double next_temperature(void)
{
	return (double)(turn++ % 1000) / 16 + 20;
}

static void event(const char *text)
{
	char why[200] = "";

	TEST_ASSERT_EQUAL_INT_MESSAGE(0, sim_scenario_event(net, text, host.now, why, sizeof(why)),
	                              why);
}

static void take(void *ctx, const struct bus_answer *answer)
{
	unsigned i = answer->id;

	(void)ctx;
	is_asked[i] = false;
	last_err = answer->err;
	took_ns = host.now - asked_ns[i];
	if (i == OTHER)
		return;
	again_ns[i] = host.now + HOST_MS / 10;
	if (answer->err) {
		failed++;
		failed_of[i / EACH]++;
		return;
	}
	good[i]++;
	wrong += strtod((char *)data[i], NULL) != set_to[i];
	old += answer->measured_ns < asked_ns[i];
}

static void ask(unsigned i, enum bus_prio prio, enum bus_op op, const char *what)
{
	snprintf(path[i], sizeof(path[i]), "%s", what);
	memset(data[i], 0, sizeof(data[i]));
	req[i] = (struct bus_req){.id = i,
	                          .op = (uint8_t)op,
	                          .prio = (uint8_t)prio,
	                          .fresh = true,
	                          .deadline_ns = host.now + 20 * HOST_S,
	                          .path = path[i],
	                          .len = sizeof(data[i]),
	                          .data = data[i]};
	if (op == BUS_WRITE) {
		snprintf((char *)data[i], sizeof(data[i]), "%u", turn++ & 1);
		req[i].len = 1;
	}
	asked_ns[i] = host.now;
	is_asked[i] = true;
	TEST_ASSERT_EQUAL_INT(0, bus_submit(bus, &req[i]));
}

/* Another temperature from now on: a value of before gives itself away. */
static void ask_thermometer(unsigned i)
{
	char text[64];

	set_to[i] = next_temperature();
	snprintf(text, sizeof(text), "set t%u temperature %.4f", i, set_to[i]);
	event(text);
	snprintf(text, sizeof(text), "/28.0000000000%02X/temperature12", i + 1);
	ask(i, BUS_INPUT, BUS_READ, text);
}

static void run(int64_t until_ns, bool until_other)
{
	while (host.now < until_ns && (!until_other || is_asked[OTHER])) {
		int64_t next = until_ns;

		for (unsigned i = 0; i < COUNT; i++) {
			if (!is_asked[i] && again_ns[i] <= host.now)
				ask_thermometer(i);
			if (!is_asked[i] && again_ns[i] < next)
				next = again_ns[i];
		}
		int64_t step = bus_step(bus, host.now);
		next = step < next ? step : next;
		host.now = next > host.now ? next : host.now;
	}
}

static void forget(void)
{
	memset(good, 0, sizeof(good));
	memset(failed_of, 0, sizeof(failed_of));
	wrong = old = failed = 0;
}

static void begin(const char *adapter)
{
	char name[] = "/tmp/owsd-together-XXXXXX", target[64];
	int fd = mkstemp(name);
	FILE *file = fd < 0 ? NULL : fdopen(fd, "w");

	TEST_ASSERT_NOT_NULL(file);
	fprintf(file, "i2c %s\n", adapter);
	for (unsigned i = 0; i < COUNT; i++) {
		if (i % EACH == 0)
			fprintf(file, "chip DS2482-100 0x%x\n", 0x18 + i / EACH);
		fprintf(file, "DS18B20%s 28.0000000000%02X as t%u\n", i == mute ? "-F" : "", i + 1,
		        i);
	}
	fprintf(file, "DS2408 29.000000000001 as board\n");
	fclose(file);
	snprintf(target, sizeof(target), "sim:%s", name);
	host_init_virtual(&host);
	host.env.answer = take;
	bus = host_bus(&host, target);
	unlink(name);
	net = plant_net(bus);
	TEST_ASSERT_TRUE(host_run_events(&host, bus, 1, host.now + HOST_S));
	host_run(&host, bus, host.now + 10 * HOST_S);
	memset(is_asked, 0, sizeof(is_asked));
	memset(again_ns, 0, sizeof(again_ns));
	run(host.now + 10 * HOST_S, false);
	forget();
}

void setUp(void)
{
	turn = 0;
	mute = COUNT;
}

void tearDown(void)
{
	if (bus)
		bus_destroy(bus);
	bus = NULL;
}

static unsigned least(unsigned chip)
{
	unsigned fewest = UINT32_MAX;

	for (unsigned i = chip * EACH; i < (chip + 1) * EACH; i++)
		fewest = good[i] < fewest ? good[i] : fewest;
	return fewest;
}

static void no_false_value(void)
{
	TEST_ASSERT_EQUAL_UINT(0, wrong);
	TEST_ASSERT_EQUAL_UINT(0, old);
}

/* Read and started by themselves, 40 take 40 times 22 ms: 0.9 s. */
static void test_each_value_is_new_after_little_more_than_a_conversion(void)
{
	begin("speed 400 combine any");
	run(host.now + 60 * HOST_S, false);
	no_false_value();
	TEST_ASSERT_EQUAL_UINT(0, failed);
	for (unsigned chip = 0; chip < CHIPS; chip++)
		TEST_ASSERT_GREATER_THAN_UINT(60000 / 815, least(chip));
}

static void test_a_slow_bus_gives_right_values_too(void)
{
	static const char *const adapters[] = {
		"speed 100 combine any", "speed 100 combine one-read", "speed 400 combine smbus"};

	for (unsigned a = 0; a < 3; a++) {
		begin(adapters[a]);
		run(host.now + 20 * HOST_S, false);
		no_false_value();
		TEST_ASSERT_EQUAL_UINT(0, failed);
		for (unsigned chip = 0; chip < CHIPS; chip++)
			TEST_ASSERT_GREATER_THAN_UINT(12, least(chip));
		tearDown();
	}
}

/* A chip that stays busy is reset, and tried again, each 10 ms at most; the others go on. */
static void test_trouble_of_one_chip_leaves_the_others_their_values(void)
{
	static const char *const troubles[] = {"stick 0x1a", "short 0x1a", "reset 0x1a"};

	for (unsigned k = 0; k < 3; k++) {
		char ends[40];

		begin("speed 400 combine any");
		for (unsigned n = 0; n < 10; n++) {
			event(troubles[k]);
			run(host.now + 500 * HOST_MS, false);
			snprintf(ends, sizeof(ends), "end %s", troubles[k]);
			if (k < 2)
				event(ends);
			run(host.now + 2500 * HOST_MS, false);
		}
		no_false_value();
		for (unsigned chip = 0; chip < CHIPS; chip++) {
			if (chip != 2)
				TEST_ASSERT_EQUAL_UINT_MESSAGE(0, failed_of[chip], troubles[k]);
			TEST_ASSERT_GREATER_THAN_UINT_MESSAGE(chip == 2 ? 15 : 25, least(chip),
			                                      troubles[k]);
		}
		tearDown();
	}
}

/* Its start is tried in vain; who is ready is read meanwhile. */
static void test_one_that_shows_no_start_leaves_the_others_their_values(void)
{
	mute = 2 * EACH + 5;
	begin("speed 400 combine any");
	run(host.now + 60 * HOST_S, false);
	no_false_value();
	for (unsigned chip = 0; chip < CHIPS; chip++) {
		TEST_ASSERT_GREATER_THAN_UINT(chip == 2 ? 40 : 60000 / 815, least(chip));
		if (chip != 2)
			TEST_ASSERT_EQUAL_UINT(0, failed_of[chip]);
	}
	TEST_ASSERT_LESS_OR_EQUAL_UINT(2, failed_of[2]);
}

/* Each of a group's starts says what it owes. */
static void test_a_start_in_vain_is_not_forgotten_for_the_next_one(void)
{
	struct schedule schedule = {0};

	schedule_owe(&schedule, OWES_OTHER);
	TEST_ASSERT_EQUAL_UINT8(OWES_OTHER, schedule.owes);
	schedule_owe(&schedule, OWES_ANY);
	schedule_owe(&schedule, OWES_OTHER);
	TEST_ASSERT_EQUAL_UINT8(OWES_ANY, schedule.owes);
}

static void test_wrong_bits_give_no_false_value(void)
{
	begin("speed 400 combine any");
	for (unsigned i = 0; i < COUNT; i += 3) {
		char text[64];

		snprintf(text, sizeof(text), "corrupt t%u chance 0.05 seed %u", i, i + 1);
		event(text);
	}
	run(host.now + 120 * HOST_S, false);
	no_false_value();
	for (unsigned i = 0; i < COUNT; i++)
		TEST_ASSERT_GREATER_THAN_UINT(60, good[i]);
}

/* One that restarts has 85 in its scratchpad, or was not made to convert. */
static void test_restarts_give_no_false_value(void)
{
	begin("speed 400 combine any");
	for (unsigned n = 0; n < 100; n++) {
		char text[40];

		snprintf(text, sizeof(text), "brownout t%u", n * 7 % COUNT);
		event(text);
		run(host.now + (300 + 17 * n) * HOST_MS, false);
	}
	no_false_value();
	for (unsigned i = 0; i < COUNT; i++)
		TEST_ASSERT_GREATER_THAN_UINT(60, good[i]);
}

static int64_t longest_wait(enum bus_prio prio, enum bus_op op, const char *what)
{
	int64_t longest = 0;

	for (unsigned n = 0; n < 80; n++) {
		run(host.now + (37 + 13 * n % 100) * HOST_MS, false);
		ask(OTHER, prio, op, what);
		run(host.now + 20 * HOST_S, true);
		TEST_ASSERT_EQUAL_INT(0, last_err);
		longest = took_ns > longest ? took_ns : longest;
	}
	TEST_ASSERT_GREATER_THAN_INT64(0, longest);
	return longest;
}

/* What goes on, and then their own transactions: a search of alarms, a write with its reading. */
static void test_alarms_outputs_and_guests_wait_for_one_group(void)
{
	begin("speed 400 combine any");
	TEST_ASSERT_LESS_THAN_INT64(GROUP_NS + 4 * 8 * HOST_MS,
	                            longest_wait(BUS_ALARM, BUS_DIR, "/alarm/29"));
	TEST_ASSERT_LESS_THAN_INT64(GROUP_NS + 2 * 16 * HOST_MS,
	                            longest_wait(BUS_OUTPUT, BUS_WRITE, "/29.000000000001/PIO.0"));
	TEST_ASSERT_LESS_THAN_INT64(
		4 * (2 * GROUP_NS + 18 * HOST_MS),
		longest_wait(BUS_GUEST, BUS_READ, "/29.000000000001/sensed.BYTE"));
	no_false_value();
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_each_value_is_new_after_little_more_than_a_conversion);
	RUN_TEST(test_a_slow_bus_gives_right_values_too);
	RUN_TEST(test_trouble_of_one_chip_leaves_the_others_their_values);
	RUN_TEST(test_one_that_shows_no_start_leaves_the_others_their_values);
	RUN_TEST(test_a_start_in_vain_is_not_forgotten_for_the_next_one);
	RUN_TEST(test_wrong_bits_give_no_false_value);
	RUN_TEST(test_restarts_give_no_false_value);
	RUN_TEST(test_alarms_outputs_and_guests_wait_for_one_group);
	return UNITY_END();
}
