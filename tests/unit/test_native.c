/* SPDX-License-Identifier: MIT */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "hal/native/native.h"
#include "hal/path.h"
#include "tests/unit/wire_link.h"
#include "unity.h"

static struct host host;
static struct bus *bus;
static struct bus_req req[256];
static uint8_t data[256][4096];
static char path[256][128];
static uint32_t next_id;

void setUp(void)
{
	host_init_virtual(&host);
	next_id = 0;
}

void tearDown(void)
{
	bus_destroy(bus);
	bus = NULL;
	wire_clear();
}

static void start(void)
{
	bus = wire_open();
	TEST_ASSERT_TRUE(host_run_events(&host, bus, 1, host.now + HOST_S));
	TEST_ASSERT_EQUAL_UINT8(BUS_UP, host.event[0].news);
}

static uint32_t ask(enum bus_op op, enum bus_prio prio, bool fresh, const char *what,
                    const char *text)
{
	uint32_t id = next_id++;

	snprintf(path[id], sizeof(path[id]), "%s", what);
	req[id] = (struct bus_req){.id = id, .op = (uint8_t)op, .prio = (uint8_t)prio, .fresh = fresh,
	                           .path = path[id], .data = data[id], .len = sizeof(data[id]),
	                           .deadline_ns = host.now + 20 * HOST_S};
	memset(data[id], 0, sizeof(data[id]));
	if (op == BUS_WRITE) {
		req[id].len = (uint32_t)strlen(text);
		memcpy(data[id], text, strlen(text));
	}
	TEST_ASSERT_EQUAL_INT(0, bus_submit(bus, &req[id]));
	return id;
}

static const struct bus_answer *answer_to(uint32_t id)
{
	int64_t until = host.now + 21 * HOST_S;

	while (!host_answer(&host, id) && host.now < until)
		host_run_answers(&host, bus, host.answers + 1, until);
	TEST_ASSERT_EQUAL_UINT(1, host_answers(&host, id));
	return host_answer(&host, id);
}

static void expect(bool fresh, const char *what, const char *text)
{
	uint32_t id = ask(BUS_READ, BUS_INPUT, fresh, what, NULL);

	TEST_ASSERT_EQUAL_INT_MESSAGE(0, answer_to(id)->err, what);
	TEST_ASSERT_EQUAL_STRING_MESSAGE(text, (char *)data[id], what);
	TEST_ASSERT_EQUAL_UINT_MESSAGE(strlen(text), answer_to(id)->len, what);
}

static int result(enum bus_op op, const char *what, const char *text)
{
	return answer_to(ask(op, BUS_INPUT, true, what, text))->err;
}

static const char *name_of(const struct sim_slave *slave)
{
	static char names[4][40];
	static unsigned turn;
	char *name = names[turn++ % 4];

	name[0] = '/';
	rom_print(slave->rom, ROM_F_I, name + 1);
	return name;
}

static const char *of(const struct sim_slave *slave, const char *property)
{
	static char paths[4][100];
	static unsigned turn;
	char *text = paths[turn++ % 4];

	snprintf(text, 100, "%s/%s", name_of(slave), property);
	return text;
}

static void test_a_thermometer_is_found_and_read(void)
{
	wire_init(&host, 1, 1);
	struct sim_slave *slave = wire_add(0, "DS18B20", 1);

	wire_set(slave, "temperature", 21.0625);
	start();
	expect(true, of(slave, "temperature"), "     21.0625");
	expect(true, of(slave, "temperature9"), "          21");
	expect(true, of(slave, "temperature12"), "     21.0625");
	expect(true, of(slave, "type"), "DS18B20");
	expect(true, of(slave, "family"), "28");
	expect(true, of(slave, "power"), "1");
	expect(true, of(slave, "tempres"), "          12");
	expect(true, of(slave, "present"), "1");
	TEST_ASSERT_EQUAL_UINT(1, host_events(&host, BUS_FOUND));
}

static void test_the_listing_has_devices_and_directories(void)
{
	wire_init(&host, 2, 2);
	wire_add(0, "DS18B20", 1);
	wire_add(1, "DS2401", 2);
	start();
	uint32_t id = ask(BUS_DIR, BUS_INPUT, true, "/", NULL);
	TEST_ASSERT_EQUAL_INT(0, answer_to(id)->err);
	TEST_ASSERT_NOT_NULL(strstr((char *)data[id], "/28.01005DDF0300\n"));
	TEST_ASSERT_NOT_NULL(strstr((char *)data[id], "/01.02005DDF0300\n"));
	TEST_ASSERT_NOT_NULL(strstr((char *)data[id], "/bus.1\n"));
	TEST_ASSERT_NOT_NULL(strstr((char *)data[id], "/alarm\n"));
	id = ask(BUS_DIR, BUS_INPUT, false, "/bus.1", NULL);
	TEST_ASSERT_EQUAL_INT(0, answer_to(id)->err);
	TEST_ASSERT_EQUAL_STRING("/bus.1/01.02005DDF0300\n/bus.1/interface\n/bus.1/simultaneous\n"
	                         "/bus.1/alarm\n", (char *)data[id]);
	id = ask(BUS_DIR, BUS_INPUT, false, "/01.02005DDF0300", NULL);
	TEST_ASSERT_EQUAL_INT(0, answer_to(id)->err);
	TEST_ASSERT_NOT_NULL(strstr((char *)data[id], "/01.02005DDF0300/address\n"));
	TEST_ASSERT_NULL(strstr((char *)data[id], "present"));
}

static void test_one_convert_serves_all_that_are_due(void)
{
	struct sim_slave *slave[20];
	uint32_t id[20];

	wire_init(&host, 2, 2);
	for (unsigned i = 0; i < 20; i++) {
		slave[i] = wire_add(i % 2, "DS18B20", i + 1);
		wire_set(slave[i], "temperature", i + 0.5);
	}
	start();
	expect(true, of(slave[0], "power"), "1");
	wire_net.convert_count = 0;
	int64_t begun = host.now;
	for (unsigned i = 0; i < 20; i++)
		id[i] = ask(BUS_READ, BUS_INPUT, true, of(slave[i], "temperature"), NULL);
	for (unsigned i = 0; i < 20; i++) {
		const struct bus_answer *answer = answer_to(id[i]);

		TEST_ASSERT_EQUAL_INT(0, answer->err);
		TEST_ASSERT_EQUAL_DOUBLE(i + 0.5, answer->number);
		TEST_ASSERT_EQUAL_UINT8(BUS_NUMBER, answer->kind);
		TEST_ASSERT_GREATER_THAN_INT64(begun, answer->measured_ns);
	}
	TEST_ASSERT_EQUAL_UINT(2, wire_net.convert_count);
	TEST_ASSERT_LESS_THAN_INT64(begun + 1100 * HOST_MS, host.now);
}

static void test_a_chip_that_takes_the_question_otherwise_does_not_divide_the_conversion(void)
{
	struct sim_slave *slave[5];
	uint32_t id[5];

	wire_init(&host, 1, 1);
	for (unsigned i = 0; i < 5; i++)
		slave[i] = wire_add(0, "DS18B20", i + 1);
	wire_add(0, "DS2438", 9);
	start();
	for (unsigned i = 0; i < 4; i++)
		id[i] = ask(BUS_READ, BUS_INPUT, true, of(slave[i], "temperature"), NULL);
	for (unsigned i = 0; i < 4; i++)
		TEST_ASSERT_EQUAL_INT(0, answer_to(id[i])->err);
	TEST_ASSERT_EQUAL_UINT(1, wire_net.convert_count);
}

static void test_parasites_get_the_strong_pull_up_for_the_whole_conversion(void)
{
	wire_init(&host, 1, 1);
	struct sim_slave *slave = wire_add(0, "DS18B20", 1);

	slave->parasite = true;
	wire_set(slave, "temperature", -10.5);
	start();
	expect(true, of(slave, "temperature"), "       -10.5");
	expect(true, of(slave, "power"), "0");
	TEST_ASSERT_EQUAL_UINT(1, wire_net.strong_count);
	TEST_ASSERT_GREATER_OR_EQUAL_INT64(750 * HOST_MS, wire_net.strong_ns);
}

static void test_a_short_is_told_and_gone_again(void)
{
	wire_init(&host, 1, 1);
	struct sim_slave *slave = wire_add(0, "DS18B20", 1);

	start();
	expect(true, of(slave, "power"), "1");
	wire_net.wire[0].shorted = true;
	TEST_ASSERT_EQUAL_INT(-ECOMM, result(BUS_READ, of(slave, "temperature"), NULL));
	TEST_ASSERT_EQUAL_INT(-ECOMM, result(BUS_READ, of(slave, "power"), NULL));
	wire_net.wire[0].shorted = false;
	expect(true, of(slave, "power"), "1");
	TEST_ASSERT_EQUAL_UINT(0, host_events(&host, BUS_LOST));
}

static void test_a_device_that_leaves_is_lost_and_found_again(void)
{
	wire_init(&host, 1, 1);
	struct sim_slave *slave = wire_add(0, "DS18B20", 1);

	wire_add(0, "DS2401", 9);
	start();
	expect(true, of(slave, "power"), "1");
	sim_wire_plug(&wire_net.wire[0], slave, false, wire_time());
	TEST_ASSERT_EQUAL_INT(-ENODEV, result(BUS_READ, of(slave, "power"), NULL));
	TEST_ASSERT_EQUAL_UINT(1, host_events(&host, BUS_LOST));
	sim_wire_plug(&wire_net.wire[0], slave, true, wire_time());
	host_run(&host, bus, host.now + 10 * HOST_S);
	TEST_ASSERT_EQUAL_UINT(3, host_events(&host, BUS_FOUND));
	expect(true, of(slave, "power"), "1");
}

static void test_the_background_search_sees_devices_come_and_go(void)
{
	wire_init(&host, 1, 1);
	struct sim_slave *slave = wire_add(0, "DS2401", 1);

	wire_add(0, "DS2401", 2);
	start();
	host_run(&host, bus, host.now + 2 * HOST_S);
	TEST_ASSERT_EQUAL_UINT(2, host_events(&host, BUS_FOUND));
	sim_wire_plug(&wire_net.wire[0], slave, false, wire_time());
	host_run(&host, bus, host.now + 15 * HOST_S);
	TEST_ASSERT_EQUAL_UINT(1, host_events(&host, BUS_LOST));
	wire_add(0, "DS2401", 3);
	host_run(&host, bus, host.now + 15 * HOST_S);
	TEST_ASSERT_EQUAL_UINT(3, host_events(&host, BUS_FOUND));
}

static void test_errors_are_those_of_the_contract(void)
{
	wire_init(&host, 1, 1);
	struct sim_slave *slave = wire_add(0, "DS18B20", 1);

	start();
	TEST_ASSERT_EQUAL_INT(-ENOENT, result(BUS_READ, of(slave, "nonsense"), NULL));
	TEST_ASSERT_EQUAL_INT(-ENOENT, result(BUS_READ, of(slave, "temperature.0"), NULL));
	TEST_ASSERT_EQUAL_INT(-ENODEV, result(BUS_READ, "/28.AABBCCDDEEFF/temperature", NULL));
	TEST_ASSERT_EQUAL_INT(-EACCES, result(BUS_WRITE, of(slave, "temperature"), "1"));
	TEST_ASSERT_EQUAL_INT(-EINVAL, result(BUS_WRITE, of(slave, "templow"), "abc"));
	TEST_ASSERT_EQUAL_INT(-EISDIR, result(BUS_READ, name_of(slave), NULL));
	TEST_ASSERT_EQUAL_INT(-ENOTDIR, result(BUS_DIR, of(slave, "temperature"), NULL));
	TEST_ASSERT_EQUAL_INT(-ENODEV, result(BUS_PROBE, "/28.AABBCCDDEEFF", NULL));
	TEST_ASSERT_EQUAL_INT(0, result(BUS_PROBE, name_of(slave), NULL));
}

static void test_limits_are_stored_with_the_resolution_that_was_there(void)
{
	wire_init(&host, 1, 1);
	struct sim_slave *slave = wire_add(0, "DS18B20", 1);

	wire_set(slave, "temperature", 20.3125);
	start();
	expect(true, of(slave, "temperature9"), "          20");
	TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, of(slave, "temphigh"), "30"));
	expect(true, of(slave, "temphigh"), "          30");
	expect(true, of(slave, "tempres"), "          12");
	sim_slave_power_on(slave, wire_time());
	expect(true, of(slave, "temphigh"), "          30");
	expect(true, of(slave, "temperature"), "     20.3125");
	TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, of(slave, "tempres"), "10"));
	expect(true, of(slave, "temperature"), "       20.25");
	expect(true, of(slave, "tempres"), "          10");
}

static void test_a_cached_value_keeps_its_time(void)
{
	wire_init(&host, 1, 1);
	struct sim_slave *slave = wire_add(0, "DS18B20", 1);

	wire_set(slave, "temperature", 20);
	start();
	uint32_t first = ask(BUS_READ, BUS_INPUT, false, of(slave, "temperature"), NULL);
	int64_t measured = answer_to(first)->measured_ns;
	wire_set(slave, "temperature", 30);
	uint32_t second = ask(BUS_READ, BUS_INPUT, false, of(slave, "temperature"), NULL);
	TEST_ASSERT_EQUAL_DOUBLE(20, answer_to(second)->number);
	TEST_ASSERT_EQUAL_INT64(measured, answer_to(second)->measured_ns);
	TEST_ASSERT_BITS_HIGH(BUS_DETAIL_CACHED, answer_to(second)->detail);
	host_run(&host, bus, host.now + 3 * HOST_S);
	expect(false, of(slave, "temperature"), "          30");
}

static void test_a_monitor_that_restarts_while_it_measures_is_measured_again(void)
{
	wire_init(&host, 1, 1);
	struct sim_slave *slave = wire_add(0, "DS2438", 1);

	wire_set(slave, "temperature", 20.5);
	start();
	host_run(&host, bus, host.now + HOST_S);
	for (unsigned ms = 0; ms < 45; ms++) {
		uint32_t id = ask(BUS_READ, BUS_INPUT, true, of(slave, "temperature"), NULL);

		host_run(&host, bus, host.now + ms * HOST_MS);
		sim_slave_brownout(slave, wire_time());
		if (answer_to(id)->err == 0)
			TEST_ASSERT_EQUAL_DOUBLE(20.5, answer_to(id)->number);
	}
	wire_set(slave, "temperature", 0);
	expect(true, of(slave, "temperature"), "           0");
}

static void test_the_power_on_value_of_the_genuine_chip_is_known_from_the_temperature(void)
{
	wire_init(&host, 1, 1);
	struct sim_slave *slave = wire_add(0, "DS18B20", 1);

	wire_set(slave, "temperature", 84.5);
	start();
	expect(true, of(slave, "temperature"), "        84.5");
	wire_set(slave, "temperature", 85);
	expect(true, of(slave, "temperature"), "          85");
	sim_slave_power_on(slave, wire_time());
	TEST_ASSERT_EQUAL_INT(-ERANGE, result(BUS_READ, of(slave, "latesttemp"), NULL));
}

/* Of a clone, whose byte 6 tells nothing. */
static void test_the_power_on_value_is_never_good(void)
{
	wire_init(&host, 1, 1);
	struct sim_slave *slave = wire_add(0, "DS18B20", 1);

	TEST_ASSERT_EQUAL_INT(0, slave->family->option(slave, "fixed", 1));
	wire_set(slave, "temperature", 20.5);
	start();
	TEST_ASSERT_EQUAL_INT(-ERANGE, result(BUS_READ, of(slave, "latesttemp"), NULL));
	expect(true, of(slave, "temperature"), "        20.5");
	expect(true, of(slave, "latesttemp"), "        20.5");
	sim_slave_power_on(slave, wire_time());
	TEST_ASSERT_EQUAL_INT(-ERANGE, result(BUS_READ, of(slave, "latesttemp"), NULL));
	TEST_ASSERT_EQUAL_UINT(1, host_events(&host, BUS_POR));
	wire_set(slave, "temperature", 85);
	TEST_ASSERT_EQUAL_INT(-ERANGE, result(BUS_READ, of(slave, "temperature"), NULL));
	wire_set(slave, "temperature", 84);
	expect(true, of(slave, "temperature"), "          84");
	wire_set(slave, "temperature", 85);
	expect(true, of(slave, "temperature"), "          85");
}

static void test_the_ladder_is_climbed_until_the_chip_answers(void)
{
	wire_init(&host, 1, 1);
	struct sim_slave *slave = wire_add(0, "DS18B20", 1);

	start();
	expect(true, of(slave, "power"), "1");
	wire_net.fault = -ETIMEDOUT;
	wire_net.fault_count = 1000;
	wire_net.fault_until = LINK_CHIP_RESET;
	expect(true, of(slave, "power"), "1");
	TEST_ASSERT_EQUAL_UINT(1, wire_net.recovered[LINK_BUS_RESET]);
	TEST_ASSERT_EQUAL_UINT(1, wire_net.recovered[LINK_CHIP_RESET]);
	wire_net.fault = -ETIMEDOUT;
	wire_net.fault_count = 100000;
	wire_net.fault_until = LINK_REOPEN + 1;
	TEST_ASSERT_EQUAL_INT(-ECONNRESET, result(BUS_READ, of(slave, "power"), NULL));
	TEST_ASSERT_EQUAL_UINT(1, host_events(&host, BUS_DOWN));
	wire_net.fault_count = 0;
	host_run(&host, bus, host.now + HOST_S);
	TEST_ASSERT_EQUAL_UINT(2, host_events(&host, BUS_UP));
	expect(true, of(slave, "power"), "1");
}

static void test_alarms_list_the_devices_in_alarm(void)
{
	wire_init(&host, 2, 2);
	struct sim_slave *slave = wire_add(0, "DS18B20", 1), *other = wire_add(1, "DS18B20", 2);

	wire_set(slave, "temperature", 40);
	wire_set(other, "temperature", 20);
	start();
	TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, of(slave, "temphigh"), "30"));
	TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, of(other, "temphigh"), "30"));
	TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, of(other, "templow"), "10"));
	TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, "/simultaneous/temperature", "1"));
	host_run(&host, bus, host.now + HOST_S);
	for (int i = 0; i < 20; i++) {
		uint32_t id = ask(BUS_DIR, BUS_ALARM, true, "/alarm", NULL);
		TEST_ASSERT_EQUAL_INT(0, answer_to(id)->err);
		TEST_ASSERT_EQUAL_STRING("/alarm/28.01005DDF0300\n", (char *)data[id]);
	}
	uint32_t id = ask(BUS_DIR, BUS_ALARM, true, "/alarm/29,28", NULL);
	TEST_ASSERT_EQUAL_INT(0, answer_to(id)->err);
	TEST_ASSERT_EQUAL_STRING("/alarm/28.01005DDF0300\n", (char *)data[id]);
	id = ask(BUS_DIR, BUS_ALARM, true, "/alarm/29", NULL);
	TEST_ASSERT_EQUAL_INT(0, answer_to(id)->err);
	TEST_ASSERT_EQUAL_STRING("", (char *)data[id]);
}

static void test_an_alarm_search_goes_no_further_than_its_family(void)
{
	static const char *const chips[] = {"DS18B20", "DS1822", "DS2406", "DS18S20"};
	uint64_t resets, slots;

	for (unsigned n = 0; n < 4; n++) {
		wire_init(&host, 1, 1);
		/* With the limits of the factory it is in alarm once it has converted. */
		struct sim_slave *slave = wire_add(0, chips[n], 1);

		wire_add(0, "DS2408", 2);
		start();
		if (strcmp(chips[n], "DS2406") != 0)
			TEST_ASSERT_EQUAL_INT(0, result(BUS_READ, of(slave, "temperature"), NULL));
		TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, "/29.02005DDF0300/por", "0"));
		TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, "/29.02005DDF0300/latch.BYTE", "0"));
		resets = wire_net.wire[0].resets;
		slots = wire_net.wire[0].slots;
		uint32_t id = ask(BUS_DIR, BUS_ALARM, true, "/alarm/29", NULL);
		TEST_ASSERT_EQUAL_INT(0, answer_to(id)->err);
		TEST_ASSERT_EQUAL_STRING("", (char *)data[id]);
		TEST_ASSERT_EQUAL_UINT64(1, wire_net.wire[0].resets - resets);
		TEST_ASSERT_LESS_OR_EQUAL_UINT64(8 + 8 * 3, wire_net.wire[0].slots - slots);
		tearDown();
		setUp();
	}
}

static void test_an_alarm_s_next_request_is_waited_for(void)
{
	struct sim_slave *slave[6], *board;
	int64_t begun;

	wire_init(&host, 1, 1);
	for (unsigned i = 0; i < 6; i++)
		slave[i] = wire_add(0, "DS18B20", i + 1);
	board = wire_add(0, "DS2408", 9);
	start();
	host_run(&host, bus, host.now + 2 * HOST_S);
	for (unsigned i = 0; i < 6; i++)
		ask(BUS_READ, BUS_INPUT, true, of(slave[i], "scratchpad"), NULL);
	for (unsigned i = 0; i < 3; i++) {
		uint32_t id = ask(BUS_READ, BUS_ALARM, true, of(board, "sensed.BYTE"), NULL);

		begun = host.now;
		TEST_ASSERT_EQUAL_INT(0, answer_to(id)->err);
		/* A thread hears of the answer a little later; the others are not begun meanwhile. */
		TEST_ASSERT_EQUAL_UINT(i + 1, host.answers);
		host_run(&host, bus, host.now + HOST_MS / 5);
		TEST_ASSERT_LESS_THAN_INT64(begun + 18 * HOST_MS, host.now);
	}
	/* Nobody asks: they go on. */
	TEST_ASSERT_TRUE(host_run_answers(&host, bus, 9, host.now + 130 * HOST_MS));
}

static void test_one_register_read_serves_por_and_latch_of_a_visit(void)
{
	struct sim_slave *board;
	uint64_t resets;
	uint32_t id;

	wire_init(&host, 1, 1);
	board = wire_add(0, "DS2408", 1);
	start();
	host_run(&host, bus, host.now + 2 * HOST_S);
	for (unsigned i = 0; i < 3; i++) {
		wire_set(board, "pin.0", i & 1);
		resets = wire_net.wire[0].resets;
		id = ask(BUS_READ, BUS_ALARM, true, of(board, "por"), NULL);
		TEST_ASSERT_EQUAL_INT(0, answer_to(id)->err);
		id = ask(BUS_READ, BUS_ALARM, true, of(board, "latch.BYTE"), NULL);
		TEST_ASSERT_EQUAL_INT(0, answer_to(id)->err);
		TEST_ASSERT_EQUAL_STRING("           1", (char *)data[id]);
		TEST_ASSERT_EQUAL_UINT64(1, wire_net.wire[0].resets - resets);
		/* The value itself is always read. */
		id = ask(BUS_READ, BUS_ALARM, true, of(board, "sensed.BYTE"), NULL);
		TEST_ASSERT_EQUAL_INT(0, answer_to(id)->err);
		TEST_ASSERT_EQUAL_UINT64(2, wire_net.wire[0].resets - resets);
		id = ask(BUS_WRITE, BUS_ALARM, true, of(board, "latch.BYTE"), "0");
		TEST_ASSERT_EQUAL_INT(0, answer_to(id)->err);
		id = ask(BUS_READ, BUS_ALARM, true, of(board, "latch.BYTE"), NULL);
		TEST_ASSERT_EQUAL_INT(0, answer_to(id)->err);
		TEST_ASSERT_EQUAL_STRING("           0", (char *)data[id]);
	}
}

static void test_an_alias_names_the_device(void)
{
	wire_init(&host, 1, 1);
	struct sim_slave *slave = wire_add(0, "DS18B20", 1);

	start();
	expect(true, of(slave, "alias"), "");
	TEST_ASSERT_EQUAL_INT(0, result(BUS_WRITE, of(slave, "alias"), "boiler"));
	expect(true, "/boiler/alias", "boiler");
	expect(true, "/boiler/id", "01005DDF0300");
	TEST_ASSERT_EQUAL_INT(-EINVAL, result(BUS_WRITE, of(slave, "alias"), "a/b"));
	TEST_ASSERT_EQUAL_INT(-EINVAL, result(BUS_WRITE, of(slave, "alias"), "bus.0"));
}

static void test_structure_states_the_properties(void)
{
	wire_init(&host, 1, 1);
	start();
	expect(true, "/structure/28/temperature12", "t,000000,000001,ro,000012,v,");
	expect(true, "/structure/28/templow", "t,000000,000001,rw,000012,s,");
	TEST_ASSERT_EQUAL_INT(-ENOENT, result(BUS_READ, "/structure/28/nonsense", NULL));
	uint32_t id = ask(BUS_DIR, BUS_INPUT, false, "/structure/28/errata", NULL);
	TEST_ASSERT_EQUAL_INT(0, answer_to(id)->err);
	TEST_ASSERT_EQUAL_STRING("/structure/28/errata/die\n/structure/28/errata/trim\n"
	                         "/structure/28/errata/trimblanket\n/structure/28/errata/trimvalid\n",
	                         (char *)data[id]);
}

static void test_an_alarm_waits_for_one_transaction_and_not_for_a_scan(void)
{
	struct sim_slave *slave[20];

	wire_init(&host, 1, 1);
	for (unsigned i = 0; i < 20; i++)
		slave[i] = wire_add(0, "DS18B20", i + 1);
	start();
	host_run(&host, bus, host.now + 2 * HOST_S);
	for (unsigned i = 0; i < 20; i++)
		ask(BUS_READ, BUS_INPUT, true, of(slave[i], "temperature"), NULL);
	while (host.answers < 5)
		host_run_answers(&host, bus, 5, host.now + 2 * HOST_S);
	int64_t begun = host.now;
	uint32_t id = ask(BUS_READ, BUS_ALARM, true, of(slave[19], "power"), NULL);
	TEST_ASSERT_EQUAL_INT(0, answer_to(id)->err);
	TEST_ASSERT_LESS_THAN_INT64(begun + 40 * HOST_MS, host.now);
	TEST_ASSERT_LESS_THAN_UINT(10, host.answers);
}

static void test_a_chip_that_takes_no_resolution_is_read_all_the_same(void)
{
	wire_init(&host, 1, 1);
	struct sim_slave *slave = wire_add(0, "DS18B20", 1);

	TEST_ASSERT_EQUAL_INT(0, slave->family->option(slave, "fixed", 1));
	wire_set(slave, "temperature", 21.0625);
	start();
	expect(true, of(slave, "temperature9"), "     21.0625");
	expect(true, of(slave, "temperature"), "     21.0625");
	TEST_ASSERT_EQUAL_INT(-EINVAL, result(BUS_WRITE, of(slave, "tempres"), "10"));
	TEST_ASSERT_EQUAL_UINT(0, host_events(&host, BUS_POR));
}

static void test_one_device_serves_two_resolutions_at_once(void)
{
	static const char *const names[] = {"temperature9", "temperature12", "temperature10",
	                                    "temperature", "temperature12"};
	static const double values[] = {21, 21.0625, 21, 21.0625, 21.0625};
	uint32_t id[5];

	wire_init(&host, 1, 1);
	struct sim_slave *slave = wire_add(0, "DS18B20", 1);

	wire_set(slave, "temperature", 21.0625);
	start();
	for (int i = 0; i < 5; i++)
		id[i] = ask(BUS_READ, BUS_INPUT, true, of(slave, names[i]), NULL);
	for (int i = 0; i < 5; i++) {
		TEST_ASSERT_EQUAL_INT(0, answer_to(id[i])->err);
		TEST_ASSERT_EQUAL_DOUBLE_MESSAGE(values[i], answer_to(id[i])->number, names[i]);
	}
}

static void test_a_request_that_was_not_begun_can_be_taken_back(void)
{
	wire_init(&host, 1, 1);
	struct sim_slave *slave = wire_add(0, "DS18B20", 1);

	start();
	host_run(&host, bus, host.now + HOST_S);
	uint32_t id = ask(BUS_READ, BUS_INPUT, true, of(slave, "power"), NULL);
	TEST_ASSERT_EQUAL_INT(0, bus_cancel(bus, id));
	TEST_ASSERT_EQUAL_INT(-ECANCELED, answer_to(id)->err);
	TEST_ASSERT_EQUAL_INT(-ENOENT, bus_cancel(bus, id));
	id = ask(BUS_READ, BUS_INPUT, true, of(slave, "temperature"), NULL);
	host_run(&host, bus, host.now + 100 * HOST_MS);
	TEST_ASSERT_EQUAL_INT(-EBUSY, bus_cancel(bus, id));
	TEST_ASSERT_EQUAL_INT(0, answer_to(id)->err);
	id = ask(BUS_READ, BUS_INPUT, true, of(slave, "temperature"), NULL);
	req[id].deadline_ns = host.now;
	TEST_ASSERT_EQUAL_INT(-ETIME, answer_to(id)->err);
	id = ask(BUS_READ, BUS_INPUT, true, of(slave, "temperature"), NULL);
	req[id].deadline_ns = host.now + 300 * HOST_MS;
	TEST_ASSERT_EQUAL_INT(-EINPROGRESS, answer_to(id)->err);
}

static void test_a_suspended_bus_lets_go_and_comes_back(void)
{
	wire_init(&host, 1, 1);
	struct sim_slave *slave = wire_add(0, "DS18B20", 1);

	start();
	host_run(&host, bus, host.now + HOST_S);
	bus_suspend(bus, true);
	TEST_ASSERT_EQUAL_UINT(1, wire_net.closes);
	TEST_ASSERT_EQUAL_INT(-ENOTCONN, result(BUS_READ, of(slave, "power"), NULL));
	bus_suspend(bus, false);
	host_run(&host, bus, host.now + HOST_S);
	TEST_ASSERT_EQUAL_UINT(2, host_events(&host, BUS_UP));
	expect(true, of(slave, "power"), "1");
}

static void test_a_target_that_does_not_open_is_tried_again_for_ever(void)
{
	wire_init(&host, 1, 1);
	struct sim_slave *slave = wire_add(0, "DS18B20", 1);

	wire_net.open_error = -ENXIO;
	bus = wire_open();
	host_run(&host, bus, host.now + 60 * HOST_S);
	TEST_ASSERT_EQUAL_UINT(1, host_events(&host, BUS_DOWN));
	TEST_ASSERT_EQUAL_STRING("no such chip", host.event[0].text);
	TEST_ASSERT_EQUAL_INT(-ENOTCONN, result(BUS_READ, of(slave, "power"), NULL));
	TEST_ASSERT_GREATER_THAN_UINT(10, wire_net.opens);
	TEST_ASSERT_LESS_THAN_UINT(30, wire_net.opens);
	wire_net.open_error = 0;
	host_run(&host, bus, host.now + 6 * HOST_S);
	expect(true, of(slave, "power"), "1");
}

static void test_a_target_without_its_file_is_refused_with_the_reason(void)
{
	struct bus *none = NULL;
	char why[200] = "";

	wire_init(&host, 1, 1);
	TEST_ASSERT_LESS_THAN_INT(0, bus_create("sim:/nowhere/at/all", &host.env, &none, why,
	                                        sizeof(why)));
	TEST_ASSERT_NULL(none);
	TEST_ASSERT_NOT_NULL(strstr(why, "/nowhere/at/all"));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_thermometer_is_found_and_read);
	RUN_TEST(test_the_listing_has_devices_and_directories);
	RUN_TEST(test_one_convert_serves_all_that_are_due);
	RUN_TEST(test_a_chip_that_takes_the_question_otherwise_does_not_divide_the_conversion);
	RUN_TEST(test_parasites_get_the_strong_pull_up_for_the_whole_conversion);
	RUN_TEST(test_a_short_is_told_and_gone_again);
	RUN_TEST(test_a_device_that_leaves_is_lost_and_found_again);
	RUN_TEST(test_the_background_search_sees_devices_come_and_go);
	RUN_TEST(test_errors_are_those_of_the_contract);
	RUN_TEST(test_limits_are_stored_with_the_resolution_that_was_there);
	RUN_TEST(test_a_cached_value_keeps_its_time);
	RUN_TEST(test_a_monitor_that_restarts_while_it_measures_is_measured_again);
	RUN_TEST(test_the_power_on_value_of_the_genuine_chip_is_known_from_the_temperature);
	RUN_TEST(test_the_power_on_value_is_never_good);
	RUN_TEST(test_the_ladder_is_climbed_until_the_chip_answers);
	RUN_TEST(test_alarms_list_the_devices_in_alarm);
	RUN_TEST(test_an_alarm_search_goes_no_further_than_its_family);
	RUN_TEST(test_an_alarm_s_next_request_is_waited_for);
	RUN_TEST(test_one_register_read_serves_por_and_latch_of_a_visit);
	RUN_TEST(test_an_alias_names_the_device);
	RUN_TEST(test_structure_states_the_properties);
	RUN_TEST(test_an_alarm_waits_for_one_transaction_and_not_for_a_scan);
	RUN_TEST(test_a_chip_that_takes_no_resolution_is_read_all_the_same);
	RUN_TEST(test_one_device_serves_two_resolutions_at_once);
	RUN_TEST(test_a_request_that_was_not_begun_can_be_taken_back);
	RUN_TEST(test_a_suspended_bus_lets_go_and_comes_back);
	RUN_TEST(test_a_target_that_does_not_open_is_tried_again_for_ever);
	RUN_TEST(test_a_target_without_its_file_is_refused_with_the_reason);
	return UNITY_END();
}
