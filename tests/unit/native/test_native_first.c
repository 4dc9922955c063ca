/* SPDX-License-Identifier: MIT */
/*
 * The first values of thermometers after a start: how long they take, with how much of the wire,
 * who else waits for them, and that none is false.
 */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "unity.h"

#include "hal/sim/event.h"
#include "tests/unit/aid/host.h"
#include "tests/unit/aid/plant.h"

#define MOST 82
#define PASS_NS (24 * HOST_MS) /* of the search, at 400 kHz */
#define READ_NS (14 * HOST_MS)
#define CONVERT_NS (750 * HOST_MS)

static struct host host;
static struct bus *bus;
static struct sim_net *net;
static struct bus_req req[MOST];
static char path[MOST][64];
static uint8_t data[MOST][64];
static int64_t begun_ns, asked_ns[MOST], took_ns[MOST], measured_ns[MOST];
static int err_of[MOST];
static unsigned answers, answer_order[MOST];
static bool spread; /* ids differ in all bits, as those of a real delivery do */

static void take(void *ctx, const struct bus_answer *answer)
{
	(void)ctx;
	answer_order[answer->id] = answers++;
	err_of[answer->id] = answer->err;
	took_ns[answer->id] = host.now - begun_ns;
	measured_ns[answer->id] = answer->measured_ns;
}

static void event(const char *text)
{
	char why[200] = "";

	TEST_ASSERT_EQUAL_INT_MESSAGE(0, sim_scenario_event(net, text, host.now, why, sizeof(why)),
	                              why);
}

static void id_of(unsigned i, char text[20])
{
	if (spread)
		snprintf(text, 20, "28.%08X%04X", (i + 1) * 2654435761u, i);
	else
		snprintf(text, 20, "28.0000000000%02X", (uint8_t)(i + 1));
}

/* So many DS18B20 on so many channels; more: lines behind them, and what they are followed by. */
static void begin(unsigned count, unsigned channels, const char *options, const char *more)
{
	char name[] = "/tmp/owsd-first-XXXXXX", target[64], id[20];
	int fd = mkstemp(name);
	FILE *file = fd < 0 ? NULL : fdopen(fd, "w");

	TEST_ASSERT_NOT_NULL(file);
	fprintf(file, "i2c speed 400 combine any\nchip DS2482-%s 0x18\n",
	        channels > 1 ? "800" : "100");
	for (unsigned i = 0; i < count; i++) {
		if (channels > 1 && i % (count / channels) == 0)
			fprintf(file, "channel %u\n", i / (count / channels));
		id_of(i, id);
		fprintf(file, "DS18B20 %s as t%u temperature %u%s\n", id, i, i % 60 + 10, options);
	}
	fprintf(file, "%s\n", more);
	fclose(file);
	snprintf(target, sizeof(target), "sim:%s", name);
	host_init_virtual(&host);
	host.env.answer = take;
	bus = host_bus(&host, target);
	unlink(name);
	net = plant_net(bus);
	TEST_ASSERT_TRUE(host_run_events(&host, bus, 1, host.now + HOST_S));
	answers = 0;
	begun_ns = host.now;
}

void setUp(void)
{
	memset(data, 0, sizeof(data));
	memset(took_ns, 0, sizeof(took_ns));
	spread = false;
}

void tearDown(void)
{
	if (bus)
		bus_destroy(bus);
	bus = NULL;
}

static void ask(unsigned i, enum bus_op op, enum bus_prio prio, bool fresh, const char *what)
{
	snprintf(path[i], sizeof(path[i]), "%s", what);
	req[i] = (struct bus_req){.id = i,
	                          .op = (uint8_t)op,
	                          .prio = (uint8_t)prio,
	                          .fresh = fresh,
	                          .deadline_ns = host.now + 20 * HOST_S,
	                          .path = path[i],
	                          .len = op == BUS_WRITE ? 1 : sizeof(data[i]),
	                          .data = data[i]};
	asked_ns[i] = host.now;
	TEST_ASSERT_EQUAL_INT(0, bus_submit(bus, &req[i]));
}

static void ask_thermometer(unsigned i, bool fresh)
{
	char id[20], text[64];

	id_of(i, id);
	snprintf(text, sizeof(text), "/%s/temperature12", id);
	ask(i, BUS_READ, BUS_INPUT, fresh, text);
}

static void run(unsigned n)
{
	int64_t until_ns = host.now + 30 * HOST_S;

	while (answers < n && host.now < until_ns) {
		int64_t next = bus_step(bus, host.now);

		next = next < until_ns ? next : until_ns;
		host.now = answers < n && next > host.now ? next : host.now;
	}
	TEST_ASSERT_EQUAL_UINT(n, answers);
}

/* On a host that takes so long for each step. */
static void run_slowly(unsigned n, int64_t step_ns)
{
	int64_t until_ns = host.now + 30 * HOST_S;

	while (answers < n && host.now < until_ns) {
		int64_t next = bus_step(bus, host.now);

		host.now = (next < until_ns && next > host.now ? next : host.now) + step_ns;
	}
	TEST_ASSERT_EQUAL_UINT(n, answers);
}

static uint64_t counter(const char *name)
{
	size_t n;
	const struct bus_counter *counters = bus_counters(bus, &n);

	for (size_t i = 0; i < n; i++)
		if (strcmp(counters[i].name, name) == 0)
			return counters[i].value;
	TEST_FAIL_MESSAGE(name);
	return 0;
}

static bool is_true(unsigned i)
{
	return !err_of[i] && strtod((char *)data[i], NULL) == i % 60 + 10 &&
	       measured_ns[i] >= begun_ns + CONVERT_NS && measured_ns[i] <= begun_ns + took_ns[i];
}

static void check_all(unsigned count)
{
	for (unsigned i = 0; i < count; i++)
		TEST_ASSERT_TRUE_MESSAGE(is_true(i), path[i]);
}

/* One conversion for all, and each read once; a third of them before the search has come to it. */
static void test_fifty_take_a_conversion_and_their_readings(void)
{
	for (unsigned fresh = 0; fresh < 2; fresh++) {
		begin(50, 1, "", "");
		for (unsigned i = 0; i < 50; i++)
			ask_thermometer(i, fresh);
		run(50);
		check_all(50);
		TEST_ASSERT_LESS_THAN_INT64(CONVERT_NS + 50 * READ_NS + 3 * PASS_NS,
		                            host.now - begun_ns);
		TEST_ASSERT_EQUAL_UINT64(1, counter("conversions"));
		TEST_ASSERT_LESS_THAN_UINT64(40, counter("search_passes"));
		TEST_ASSERT_EQUAL_UINT64(50, counter("devices_found"));
		/* What was found so is there when the search has ended, too. */
		host_run(&host, bus, host.now + 20 * HOST_S);
		TEST_ASSERT_EQUAL_UINT64(50, counter("devices_found"));
		TEST_ASSERT_EQUAL_UINT64(0, counter("devices_lost"));
		tearDown();
	}
}

/* The search is not over when the first values are there: the next ones do not wait for its end. */
static void test_the_next_reading_does_not_wait_for_the_end_of_the_search(void)
{
	begin(50, 1, "", "");
	for (unsigned i = 0; i < 50; i++)
		ask_thermometer(i, true);
	run(50);
	int64_t asked_after_ns = host.now - begun_ns;
	TEST_ASSERT_LESS_THAN_UINT64(40, counter("search_passes"));
	memset(data[49], 0, sizeof(data[49]));
	ask_thermometer(49, true);
	run(51);
	TEST_ASSERT_TRUE_MESSAGE(is_true(49), path[49]);
	TEST_ASSERT_GREATER_OR_EQUAL_INT64(begun_ns + asked_after_ns + CONVERT_NS, measured_ns[49]);
	TEST_ASSERT_LESS_THAN_INT64(asked_after_ns + CONVERT_NS + READ_NS + 3 * PASS_NS,
	                            took_ns[49]);
	TEST_ASSERT_EQUAL_UINT64(2, counter("conversions"));
	host_run(&host, bus, host.now + 20 * HOST_S);
	TEST_ASSERT_EQUAL_UINT64(50, counter("devices_found"));
}

/* As an engine does that spreads its first requests over a second. */
static void test_requests_may_come_later(void)
{
	begin(50, 1, "", "");
	for (unsigned i = 0; i < 50; i++) {
		ask_thermometer(i, false);
		host_run(&host, bus, host.now + 15 * HOST_MS);
	}
	run(50);
	for (unsigned i = 0; i < 50; i++)
		TEST_ASSERT_TRUE(is_true(i));
	TEST_ASSERT_LESS_THAN_INT64(CONVERT_NS + 50 * READ_NS + 4 * PASS_NS, host.now - begun_ns);
	TEST_ASSERT_EQUAL_UINT64(1, counter("conversions"));
}

/* A request that insists on a conversion of its own, and comes when all convert. */
static void test_who_insists_gets_a_conversion_of_his_own(void)
{
	begin(20, 1, "", "");
	ask_thermometer(0, true);
	host_run(&host, bus, host.now + 200 * HOST_MS);
	for (unsigned i = 1; i < 20; i++)
		ask_thermometer(i, true);
	run(20);
	check_all(20);
	for (unsigned i = 0; i < 20; i++)
		TEST_ASSERT_GREATER_OR_EQUAL_INT64(asked_ns[i], measured_ns[i]);
	TEST_ASSERT_GREATER_OR_EQUAL_UINT64(2, counter("conversions"));
}

static void test_few_wait_for_the_conversion_alone(void)
{
	begin(10, 1, "", "");
	for (unsigned i = 0; i < 10; i++)
		ask_thermometer(i, true);
	run(10);
	check_all(10);
	TEST_ASSERT_LESS_THAN_INT64(CONVERT_NS + 10 * READ_NS + 3 * PASS_NS, host.now - begun_ns);
}

/* Whose wire is not known is read when it is found; all wires convert meanwhile. */
static void test_wires_convert_while_they_are_searched(void)
{
	begin(80, 8, "", "");
	for (unsigned i = 0; i < 80; i++)
		ask_thermometer(i, true);
	run(80);
	check_all(80);
	TEST_ASSERT_LESS_THAN_INT64(80 * (PASS_NS + READ_NS) + 8 * 30 * HOST_MS,
	                            host.now - begun_ns);
	TEST_ASSERT_EQUAL_UINT64(8, counter("conversions"));
}

static void test_an_id_that_is_not_there_is_no_device(void)
{
	begin(30, 1, "", "");
	for (unsigned i = 0; i < 31; i++)
		ask_thermometer(i, false);
	run(31);
	check_all(30);
	for (unsigned i = 0; i < 30; i++)
		TEST_ASSERT_LESS_THAN_INT64(CONVERT_NS + 31 * READ_NS + 2 * PASS_NS, took_ns[i]);
	TEST_ASSERT_LESS_THAN_INT64(CONVERT_NS + 31 * READ_NS + 32 * PASS_NS, took_ns[30]);
	TEST_ASSERT_EQUAL_INT(-ENODEV, err_of[30]);
	TEST_ASSERT_EQUAL_UINT64(30, counter("devices_found"));
}

/* On which wire each is a search of a few bits tells, while all convert. */
static void test_wires_are_guessed_while_they_convert(void)
{
	spread = true;
	begin(80, 8, "", "");
	for (unsigned i = 0; i < 80; i++)
		ask_thermometer(i, true);
	run(80);
	check_all(80);
	TEST_ASSERT_LESS_THAN_INT64(CONVERT_NS + 80 * READ_NS + 4 * PASS_NS, host.now - begun_ns);
	TEST_ASSERT_EQUAL_UINT64(8, counter("conversions"));
	/* Each was guessed once, and few were found by the search for all. */
	TEST_ASSERT_LESS_THAN_UINT64(90, counter("search_passes"));
	TEST_ASSERT_EQUAL_UINT64(80, counter("devices_found"));
	host_run(&host, bus, host.now + 20 * HOST_S);
	TEST_ASSERT_EQUAL_UINT64(80, counter("devices_found"));
	TEST_ASSERT_EQUAL_UINT64(0, counter("devices_lost"));
}

/* A coupler that is found while they convert stands in front of its wire from then on. */
static void test_a_coupler_may_be_found_on_a_guessed_wire(void)
{
	spread = true;
	begin(80, 8, "", "channel 0\nDS2409 1F.000000000001");
	for (unsigned i = 0; i < 80; i++)
		ask_thermometer(i, true);
	run(80);
	check_all(80);
}

/* Strangers that begin as those that are asked for: the search for all finds who is where. */
static void test_a_wrong_guess_is_put_right(void)
{
	char more[1400] = "";

	spread = true;
	for (unsigned i = 0; i < 16; i++) {
		size_t used = strlen(more);

		/* The first bits on the wire are those of the first byte behind the family. */
		snprintf(more + used, sizeof(more) - used, "%sDS18B20 28.%08X%04X temperature 99\n",
		         i ? "" : "channel 0\n", ((40 + i) * 2654435761u) ^ 0x55, 7u);
	}
	begin(80, 8, "", more);
	for (unsigned i = 0; i < 80; i++)
		ask_thermometer(i, true);
	run(80);
	check_all(80);
	host_run(&host, bus, host.now + 20 * HOST_S);
	TEST_ASSERT_EQUAL_UINT64(96, counter("devices_found"));
	TEST_ASSERT_EQUAL_UINT64(0, counter("devices_lost"));
}

/* A bridge among them that has just got power: it has no id until somebody wakes it. */
static void begin_asleep(unsigned count, unsigned channels)
{
	char name[] = "/tmp/owsd-first-XXXXXX", why[200] = "";
	int fd = mkstemp(name);
	FILE *file = fd < 0 ? NULL : fdopen(fd, "w");

	TEST_ASSERT_NOT_NULL(file);
	fputs("sensor any\n\twrite 0 read 1\n\tvalue light = u8(0) range 0 to 255\nat 56.123456789ABC any 0x44\n",
	      file);
	fclose(file);
	spread = true;
	begin(count, channels, "", "channel 0\nDS28E18 56.123456789ABC as bridge");
	TEST_ASSERT_EQUAL_INT_MESSAGE(0, bus_option(bus, "Sensors", name, why, sizeof(why)), why);
	unlink(name);
}

/* A short search that meets it wakes it. */
static void test_a_bridge_that_is_guessed_is_woken(void)
{
	static const uint8_t zeros[6];

	begin_asleep(80, 8);
	host.events = 0;
	for (unsigned i = 0; i < 80; i++)
		ask_thermometer(i, true);
	run(80);
	host_run(&host, bus, host.now + 20 * HOST_S);
	check_all(80);
	bool found = false;
	for (unsigned i = 0; i < host.events; i++) {
		const uint8_t *rom = host.event[i].rom;

		TEST_ASSERT_FALSE(rom[0] == 0x56 && memcmp(rom + 1, zeros, sizeof(zeros)) == 0);
		found |= rom[0] == 0x56;
	}
	TEST_ASSERT_TRUE(found);
	TEST_ASSERT_EQUAL_UINT64(81, counter("devices_found"));
}

/* Nobody hears its id before it is woken: it is looked for once more then, and is not away. */
static void test_a_bridge_that_is_asked_for_is_woken(void)
{
	static const unsigned channels[] = {1, 8};

	for (unsigned k = 0; k < 2; k++) {
		begin_asleep(16, channels[k]);
		for (unsigned i = 0; i < 16; i++)
			ask_thermometer(i, true);
		ask(16, BUS_READ, BUS_INPUT, true, "/56.123456789ABC/present");
		run(17);
		TEST_ASSERT_EQUAL_INT(0, err_of[16]);
		check_all(16);
		tearDown();
	}
}

/* Outputs before inputs: the device is looked for, and nobody else is before. */
static void test_an_output_is_written_first(void)
{
	static const unsigned channels[] = {1, 8};

	for (unsigned k = 0; k < 2; k++) {
		spread = k;
		begin(40, channels[k], "", "DS2408 29.123456789ABC as board");
		for (unsigned i = 0; i < 40; i++)
			ask_thermometer(i, false);
		data[40][0] = '1';
		ask(40, BUS_WRITE, BUS_OUTPUT, false, "/29.123456789ABC/PIO.0");
		run(1);
		TEST_ASSERT_LESS_THAN_UINT64(4, counter("search_passes"));
		run(41);
		check_all(40);
		TEST_ASSERT_EQUAL_INT(0, err_of[40]);
		TEST_ASSERT_EQUAL_UINT(0, answer_order[40]);
		TEST_ASSERT_LESS_THAN_INT64(2 * PASS_NS + 60 * HOST_MS, took_ns[40]);
		tearDown();
	}
}

/* ... and one that is not there is away only when it is behind no coupler either. */
static void test_an_output_behind_a_coupler_waits_for_the_search(void)
{
	begin(10, 1, "",
	      "DS2409 1F.000000000001 as c\nbranch c main\nDS2408 29.000000000001 as board");
	for (unsigned i = 0; i < 10; i++)
		ask_thermometer(i, false);
	data[10][0] = data[11][0] = '1';
	ask(10, BUS_WRITE, BUS_OUTPUT, false, "/29.000000000001/PIO.0");
	ask(11, BUS_WRITE, BUS_OUTPUT, false, "/29.000000000002/PIO.0");
	run(12);
	check_all(10);
	TEST_ASSERT_EQUAL_INT(0, err_of[10]);
	TEST_ASSERT_EQUAL_INT(-ENODEV, err_of[11]);
}

/* Another input needs no search either; it and the first readings have their turns. */
static void test_another_input_has_its_turn(void)
{
	begin(40, 1, "", "DS2408 29.000000000001 as board");
	for (unsigned i = 0; i < 40; i++)
		ask_thermometer(i, false);
	ask(40, BUS_READ, BUS_INPUT, false, "/29.000000000001/sensed.0");
	run(1);
	TEST_ASSERT_LESS_THAN_UINT64(4, counter("search_passes"));
	/* It is asked for again and again. */
	for (unsigned done = 0; done < 40;) {
		TEST_ASSERT_LESS_THAN_UINT(500, answers);
		if (took_ns[40])
			ask(40, BUS_READ, BUS_INPUT, true, "/29.000000000001/sensed.0");
		took_ns[40] = 0;
		run(answers + 1);
		done = 0;
		for (unsigned k = 0; k < 40; k++)
			done += took_ns[k] != 0;
	}
	check_all(40);
	for (unsigned i = 0; i < 40; i++)
		TEST_ASSERT_LESS_THAN_INT64(CONVERT_NS + 80 * READ_NS + 6 * PASS_NS, took_ns[i]);
}

/* No request waits for more than the search that meets its device. */
static void test_the_only_device_answers_at_once(void)
{
	for (unsigned prio = BUS_ALARM; prio <= BUS_GUEST; prio++) {
		begin(0, 1, "", "DS2408 29.000000000001 as board");
		ask(0, BUS_READ, (enum bus_prio)prio, true, "/29.000000000001/sensed.0");
		run(1);
		TEST_ASSERT_EQUAL_INT(0, err_of[0]);
		TEST_ASSERT_LESS_THAN_INT64(4 * PASS_NS, took_ns[0]);
		tearDown();
	}
}

/*
 * The list of alarms, or an output that an alias names, waits for the search: no input goes before
 * it, that would read an output which has yet to be written again.
 */
static void test_no_input_goes_before_an_alarm(void)
{
	begin(20, 1, "", "DS2408 29.000000000001 as board");
	for (unsigned i = 0; i < 20; i++)
		ask_thermometer(i, false);
	ask(20, BUS_READ, BUS_INPUT, true, "/29.000000000001/PIO.BYTE");
	ask(21, BUS_DIR, BUS_ALARM, true, "/alarm");
	run(22);
	check_all(20);
	TEST_ASSERT_EQUAL_UINT(0, answer_order[21]);
	TEST_ASSERT_EQUAL_INT(0, err_of[20]);
}

/* Whoever is gone is away when all are searched for, and not before; for outputs, too. */
static void test_who_went_while_the_adapter_was_lost_is_away(void)
{
	static const enum bus_prio prio[] = {BUS_ALARM, BUS_INPUT};

	for (unsigned k = 0; k < 2; k++) {
		begin(10, 1, "", "DS2408 29.000000000001 as board");
		ask(10, BUS_READ, BUS_INPUT, true, "/29.000000000001/PIO.0");
		run(1);
		host_run(&host, bus, host.now + 10 * HOST_S);
		event("remove adapter for 3s");
		ask_thermometer(0, true);
		run(2);
		event("unplug board");
		unsigned events = host.events;
		while (host.event[host.events - 1].news != BUS_UP || host.events == events)
			host_run(&host, bus, host.now + 5 * HOST_MS);
		begun_ns = host.now;
		data[11][0] = data[12][0] = '1';
		answers = 0;
		ask(10, BUS_READ, prio[k], true, "/29.000000000001/PIO.0");
		ask(11, BUS_WRITE, BUS_OUTPUT, false, "/29.000000000001/PIO.BYTE");
		ask(12, BUS_WRITE, BUS_OUTPUT, false, "/29.000000000001/PIO.0");
		run(3);
		for (unsigned i = 10; i < 13; i++) {
			TEST_ASSERT_EQUAL_INT(-ENODEV, err_of[i]);
			TEST_ASSERT_LESS_THAN_INT64(2 * HOST_S, took_ns[i]);
			TEST_ASSERT_GREATER_THAN_INT64(10 * PASS_NS, took_ns[i]);
		}
		TEST_ASSERT_EQUAL_UINT64(1, counter("devices_lost"));
		tearDown();
	}
}

/* After the adapter was gone all is asked at once, and who is on another wire now is not away. */
static void test_after_the_adapter_was_lost(void)
{
	begin(30, 1, "",
	      "DS2408 29.000000000001 as here\nchip DS2482-100 0x19\n"
	      "DS2408 29.000000000001 as there unplugged");
	for (unsigned i = 0; i < 30; i++)
		ask_thermometer(i, false);
	ask(30, BUS_READ, BUS_INPUT, false, "/29.000000000001/sensed.0");
	run(31);
	host_run(&host, bus, host.now + 10 * HOST_S);
	for (unsigned move = 0; move < 2; move++) {
		unsigned events = host.events;

		event("remove adapter for 3s");
		answers = 0;
		ask_thermometer(0, true);
		run(1);
		if (move) {
			event("unplug here");
			event("plug there");
		}
		while (host.event[host.events - 1].news != BUS_UP || host.events == events)
			host_run(&host, bus, host.now + 5 * HOST_MS);
		begun_ns = host.now;
		answers = 0;
		memset(data, 0, sizeof(data));
		for (unsigned i = 0; i < 30; i++)
			ask_thermometer(i, false);
		ask(30, BUS_READ, BUS_INPUT, false, "/29.000000000001/sensed.0");
		data[31][0] = '1';
		ask(31, BUS_WRITE, BUS_OUTPUT, false, "/29.000000000001/PIO.0");
		for (unsigned n = 0; n < 2; n++) {
			char text[64];

			snprintf(text, sizeof(text), "/bus.%u/29.000000000001/sensed.1", n);
			ask(32 + n, BUS_READ, BUS_INPUT, false, text);
		}
		run(34);
		check_all(30);
		TEST_ASSERT_EQUAL_INT(0, err_of[30]);
		TEST_ASSERT_EQUAL_INT(0, err_of[31]);
		TEST_ASSERT_EQUAL_INT(0, err_of[32 + move]);
		TEST_ASSERT_LESS_THAN_INT64(CONVERT_NS + 30 * READ_NS + 8 * PASS_NS, took_ns[29]);
		/* Nor is it called lost, while nobody has looked everywhere. */
		TEST_ASSERT_EQUAL_UINT64(0, counter("devices_lost"));
		if (!move) {
			TEST_ASSERT_EQUAL_UINT(0, answer_order[31]);
			TEST_ASSERT_EQUAL_UINT(1, answer_order[30]);
			TEST_ASSERT_EQUAL_INT(-ENODEV, err_of[33]);
		}
	}
}

/* Those that the wire feeds need its strong pull-up: all is as it was. */
static void test_a_parasitic_one_is_fed(void)
{
	static const char *const kinds[] = {
		" parasite", "\nDS18B20 28.000000000050 as p temperature 7 parasite"};

	for (unsigned k = 0; k < 2; k++) {
		begin(8, 1, k ? "" : kinds[0], k ? kinds[1] : "");
		for (unsigned i = 0; i < 8; i++)
			ask_thermometer(i, true);
		run(8);
		check_all(8);
		tearDown();
	}
}

/* It has not heard that all were to convert, and holds the 85 of its power-on. */
static void test_one_that_comes_meanwhile_is_not_taken_for_one_that_converts(void)
{
	for (int64_t at = 0; at < HOST_S; at += 50 * HOST_MS) {
		begin(20, 1, "", "");
		event("unplug t13");
		for (unsigned i = 0; i < 20; i++)
			ask_thermometer(i, true);
		host_run(&host, bus, host.now + at);
		event("plug t13");
		run(20);
		for (unsigned i = 0; i < 20; i++)
			TEST_ASSERT_TRUE(is_true(i) || (i == 13 && err_of[i]));
		tearDown();
	}
}

/* A scratchpad of 9 bits is no value of 12. */
static void test_a_coarse_one_converts_again(void)
{
	begin(10, 1, ".0625 resolution 9", "");
	for (unsigned i = 0; i < 10; i++)
		ask_thermometer(i, true);
	run(10);
	for (unsigned i = 0; i < 10; i++) {
		TEST_ASSERT_EQUAL_INT(0, err_of[i]);
		TEST_ASSERT_TRUE(strtod((char *)data[i], NULL) == i % 60 + 10 + 0.0625);
	}
}

/* Family code 3B is of several chips. */
static void test_a_chip_that_has_to_tell_what_it_is_does_so_first(void)
{
	begin(5, 1, "", "MAX31850 3B.000000000001 as m temperature 21 thermocouple 90");
	for (unsigned i = 0; i < 5; i++)
		ask_thermometer(i, true);
	ask(5, BUS_READ, BUS_INPUT, true, "/3B.000000000001/thermocouple");
	run(6);
	check_all(5);
}

/* Every third of the blocks that some of them send has a bit that is turned over. */
static void test_noise_makes_no_false_value(void)
{
	for (unsigned seed = 1; seed <= 12; seed++) {
		begin(20, 1, "", "");
		for (unsigned i = 0; i < 20; i += 3) {
			char text[60];

			snprintf(text, sizeof(text), "corrupt t%u chance 0.3 seed %u", i, seed + i);
			event(text);
		}
		for (unsigned i = 0; i < 21; i++)
			ask_thermometer(i, false);
		run(21);
		for (unsigned i = 0; i < 20; i++)
			TEST_ASSERT_TRUE(is_true(i) || (i % 3 == 0 && err_of[i]));
		TEST_ASSERT_NOT_EQUAL_INT(0, err_of[20]);
		tearDown();
	}
}

/*
 * The first conversions are too old for the last ones, whose readings come so late. The search, in
 * which nobody reads, would take seven seconds.
 */
static void test_what_a_slow_host_reads_too_late_converts_again_before_the_search_has_ended(void)
{
	spread = true;
	begin(50, 1, "", "");
	for (unsigned i = 0; i < 50; i++)
		ask_thermometer(i, true);
	run_slowly(50, 120 * HOST_MS);
	for (unsigned i = 0; i < 50; i++) {
		TEST_ASSERT_EQUAL_INT(0, err_of[i]);
		TEST_ASSERT_LESS_THAN_INT64(10 * HOST_S, took_ns[i]);
		TEST_ASSERT_LESS_THAN_INT64(6 * HOST_S, begun_ns + took_ns[i] - measured_ns[i]);
	}
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_fifty_take_a_conversion_and_their_readings);
	RUN_TEST(test_the_next_reading_does_not_wait_for_the_end_of_the_search);
	RUN_TEST(test_requests_may_come_later);
	RUN_TEST(test_who_insists_gets_a_conversion_of_his_own);
	RUN_TEST(test_few_wait_for_the_conversion_alone);
	RUN_TEST(test_wires_convert_while_they_are_searched);
	RUN_TEST(test_an_id_that_is_not_there_is_no_device);
	RUN_TEST(test_wires_are_guessed_while_they_convert);
	RUN_TEST(test_a_coupler_may_be_found_on_a_guessed_wire);
	RUN_TEST(test_a_wrong_guess_is_put_right);
	RUN_TEST(test_a_bridge_that_is_guessed_is_woken);
	RUN_TEST(test_a_bridge_that_is_asked_for_is_woken);
	RUN_TEST(test_an_output_is_written_first);
	RUN_TEST(test_an_output_behind_a_coupler_waits_for_the_search);
	RUN_TEST(test_another_input_has_its_turn);
	RUN_TEST(test_the_only_device_answers_at_once);
	RUN_TEST(test_no_input_goes_before_an_alarm);
	RUN_TEST(test_who_went_while_the_adapter_was_lost_is_away);
	RUN_TEST(test_after_the_adapter_was_lost);
	RUN_TEST(test_a_parasitic_one_is_fed);
	RUN_TEST(test_one_that_comes_meanwhile_is_not_taken_for_one_that_converts);
	RUN_TEST(test_a_coarse_one_converts_again);
	RUN_TEST(test_a_chip_that_has_to_tell_what_it_is_does_so_first);
	RUN_TEST(test_noise_makes_no_false_value);
	RUN_TEST(test_what_a_slow_host_reads_too_late_converts_again_before_the_search_has_ended);
	return UNITY_END();
}
