/* SPDX-License-Identifier: MIT */
/* Devices of many kinds behind a DS9490R, and what becomes of them when it fails. */
#include <errno.h>
#include <string.h>

#include "unity.h"

#include "hal/native/native.h"
#include "tests/unit/aid/usb_scene.h"

static const char house[] = "chip DS2482-100 0x18\n"
			    "DS1420 81.000000000001\n"
			    "DS18B20 28.0000000000E1 temperature 21.5\n"
			    "DS18S20 10.0000000000E3 temperature -7.5\n"
			    "DS2405 05.0000000000E3 as switch\n"
			    "DS2408 29.0000000000E3\n"
			    "DS2413 3A.0000000000F1\n"
			    "DS2438 26.0000000000C5 vad 2.3 vdd 5\n"
			    "DS2450 20.0000000000E3 volt.A 2.56\n"
			    "DS2423 1D.0000000000E1\n"
			    "DS2431 2D.0000000000E3 memory 0 E1E3F1C5E3E3\n"
			    "DS2409 1F.0000000000E3 as coupler\n"
			    "branch coupler main\n"
			    "DS18B20 28.0000000000E5 temperature 30.25\n"
			    "branch coupler aux\n"
			    "DS2413 3A.0000000000E5\n"
			    "channel 0\n"
			    "DS18B20 28.0000000000E7 as fed temperature 4 parasite\n";

static const struct {
	const char *path, *text;
} readings[] = {
	{"/28.0000000000E1/temperature", "21.5"},
	{"/10.0000000000E3/temperature", "-7.5"},
	{"/05.0000000000E3/PIO", "0"},
	{"/29.0000000000E3/sensed.BYTE", "255"},
	{"/3A.0000000000F1/sensed.ALL", "1,1"},
	{"/1D.0000000000E1/counter.A", "0"},
	{"/1F.0000000000E3/main/28.0000000000E5/temperature", "30.25"},
	{"/28.0000000000E5/temperature", "30.25"},
	{"/3A.0000000000E5/sensed.ALL", "1,1"},
};

static struct bus *bus;
static struct bus_req req;
static uint8_t data[512];
static uint32_t id;

void setUp(void)
{
	sticks_begin();
	bus = NULL;
}

void tearDown(void)
{
	TEST_ASSERT_EQUAL_UINT64(0, sim_ds2490_forbidden(&sticks.stick[0].chip));
	if (bus)
		native_destroy(bus);
	sticks_end();
}

static const struct bus_answer *ask(enum bus_op op, const char *path, const char *text)
{
	req = (struct bus_req){.id = ++id,
	                       .op = (uint8_t)op,
	                       .prio = BUS_INPUT,
	                       .fresh = true,
	                       .deadline_ns = sticks.host.now + 20 * HOST_S,
	                       .path = path,
	                       .len = text ? (uint32_t)strlen(text) : sizeof(data),
	                       .data = data};
	if (text)
		memcpy(data, text, strlen(text));
	sticks.host.answers = 0;
	TEST_ASSERT_EQUAL_INT(0, bus_submit(bus, &req));
	TEST_ASSERT_TRUE_MESSAGE(
		host_run_answers(&sticks.host, bus, 1, sticks.host.now + 30 * HOST_S), path);
	return host_answer(&sticks.host, id);
}

static void expect(const char *path, const char *text)
{
	const struct bus_answer *answer = ask(BUS_READ, path, NULL);
	char got[64] = "";

	TEST_ASSERT_EQUAL_INT_MESSAGE(0, answer->err, path);
	memcpy(got, data, answer->len < sizeof(got) ? answer->len : sizeof(got) - 1);
	TEST_ASSERT_EQUAL_STRING_MESSAGE(text, got + strspn(got, " "), path);
}

static void read_all(void)
{
	for (size_t i = 0; i < sizeof(readings) / sizeof(readings[0]); i++)
		expect(readings[i].path, readings[i].text);
}

static void test_it_reads_writes_and_feeds(void)
{
	static const uint8_t memory[6] = {0xE1, 0xE3, 0xF1, 0xC5, 0xE3, 0xE3};

	bus = sticks_bus(house);
	read_all();
	expect("/28.0000000000E7/temperature", "4");
	expect("/20.0000000000E3/volt.A", "2.56004");
	TEST_ASSERT_EQUAL_INT(0, ask(BUS_READ, "/2D.0000000000E3/memory", NULL)->err);
	TEST_ASSERT_EQUAL_HEX8_ARRAY(memory, data, sizeof(memory));
	TEST_ASSERT_EQUAL_INT(0, ask(BUS_WRITE, "/3A.0000000000E5/PIO.ALL", "1,0")->err);
	expect("/3A.0000000000E5/PIO.ALL", "1,0");
	TEST_ASSERT_EQUAL_INT(0, ask(BUS_WRITE, "/05.0000000000E3/PIO", "1")->err);
	expect("/05.0000000000E3/PIO", "1");
	TEST_ASSERT_EQUAL_INT(0, ask(BUS_WRITE, "/2D.0000000000E3/pages/page.1", "\xE3\xE3")->err);
}

static void test_a_silent_adapter_is_down_within_three_seconds_of_work(void)
{
	int64_t begun;

	bus = sticks_bus(house);
	for (unsigned endpoint = 0; endpoint < 4; endpoint++) {
		unsigned downs = host_events(&sticks.host, BUS_DOWN);

		sticks.stick[0].chip.silent = (uint8_t)(1 << endpoint);
		sticks.stick[0].deaf = true;
		begun = sticks.host.now;
		TEST_ASSERT_NOT_EQUAL_INT(0, ask(BUS_READ, readings[3].path, NULL)->err);
		TEST_ASSERT_LESS_THAN_INT64(3 * HOST_S, sticks.host.now - begun);
		host_run(&sticks.host, bus, sticks.host.now + HOST_S);
		TEST_ASSERT_EQUAL_UINT(downs + 1, host_events(&sticks.host, BUS_DOWN));
		sticks.stick[0].chip.silent = 0;
		sticks.stick[0].deaf = false;
		host_run(&sticks.host, bus, sticks.host.now + 2 * HOST_S);
		TEST_ASSERT_EQUAL_UINT(downs + 2, host_events(&sticks.host, BUS_UP));
		read_all();
	}
}

static void test_one_that_is_pulled_is_down_at_once_and_up_at_another_port(void)
{
	int64_t begun;

	bus = sticks_bus(house);
	stick_pull(&sticks.stick[0]);
	begun = sticks.host.now;
	TEST_ASSERT_NOT_EQUAL_INT(0, ask(BUS_READ, readings[0].path, NULL)->err);
	host_run(&sticks.host, bus, sticks.host.now + HOST_S / 10);
	TEST_ASSERT_EQUAL_UINT(1, host_events(&sticks.host, BUS_DOWN));
	TEST_ASSERT_LESS_THAN_INT64(HOST_S / 2, sticks.host.now - begun);
	host_run(&sticks.host, bus, sticks.host.now + 10 * HOST_S);
	stick_plug(&sticks.stick[0], "2-1.3");
	host_run(&sticks.host, bus, sticks.host.now + 3 * HOST_S);
	TEST_ASSERT_EQUAL_UINT(2, host_events(&sticks.host, BUS_UP));
	read_all();
}

/* The error of the last BUS_DOWN of so many. */
static int down_of(unsigned count)
{
	int err = 0;

	TEST_ASSERT_EQUAL_UINT(count, host_events(&sticks.host, BUS_DOWN));
	for (unsigned i = 0; i < sticks.host.events; i++)
		if (sticks.host.event[i].news == BUS_DOWN)
			err = sticks.host.event[i].err;
	return err;
}

static void test_one_that_is_back_and_cannot_be_opened_is_not_called_gone(void)
{
	bus = sticks_bus(house);
	stick_pull(&sticks.stick[0]);
	host_run(&sticks.host, bus, sticks.host.now + 10 * HOST_S);
	TEST_ASSERT_EQUAL_INT(-ENODEV, down_of(1));
	sticks.stick[0].refuses = -EACCES;
	stick_plug(&sticks.stick[0], "1-2");
	host_run(&sticks.host, bus, sticks.host.now + 10 * HOST_S);
	TEST_ASSERT_EQUAL_INT(-EACCES, down_of(2));
	sticks.stick[0].refuses = -EBUSY;
	host_run(&sticks.host, bus, sticks.host.now + 10 * HOST_S);
	stick_pull(&sticks.stick[0]);
	host_run(&sticks.host, bus, sticks.host.now + 10 * HOST_S);
	TEST_ASSERT_EQUAL_INT(-ENODEV, down_of(3));
	sticks.stick[0].refuses = 0;
	stick_plug(&sticks.stick[0], "1-2");
	host_run(&sticks.host, bus, sticks.host.now + 10 * HOST_S);
	TEST_ASSERT_EQUAL_UINT(2, host_events(&sticks.host, BUS_UP));
	read_all();
	TEST_ASSERT_EQUAL_INT(-ENODEV, down_of(3));
}

/* Whenever the wire is short: an error or the temperature, and never 0 degrees. */
static void test_a_short_is_no_value(void)
{
	unsigned failed = 0;

	bus = sticks_bus("chip DS2482-100 0x18\nDS18B20 28.0000000000E1 temperature 21.5\n");
	for (unsigned i = 0; i < 40; i++) {
		struct sim_net *net = &sticks.stick[0].net;
		struct sim_event event = {.what = SIM_SHORT, .on = true};

		event.at_ns = net->time + i * 20 * HOST_MS;
		TEST_ASSERT_EQUAL_INT(0, sim_net_add_event(net, &event));
		event.on = false;
		event.at_ns += 30 * HOST_S;
		TEST_ASSERT_EQUAL_INT(0, sim_net_add_event(net, &event));
		const struct bus_answer *answer = ask(BUS_READ, readings[0].path, NULL);

		if (!answer->err) {
			TEST_ASSERT_EQUAL_UINT(BUS_NUMBER, answer->kind);
			TEST_ASSERT_TRUE(answer->number == 21.5);
		}
		failed += answer->err != 0;
		host_run(&sticks.host, bus, sticks.host.now + 40 * HOST_S);
		expect(readings[0].path, "21.5");
	}
	TEST_ASSERT_GREATER_THAN_UINT(20, failed);
}

/* Each value is the true one, or an error. */
static void test_transfers_that_fail_make_no_value(void)
{
	bus = sticks_bus(house);
	sticks.fail = -EIO;
	for (unsigned n = 1; n < 60; n++) {
		sticks.fail_at = sticks.transfers + n;
		const struct bus_answer *answer = ask(BUS_READ, readings[n % 2].path, NULL);

		if (!answer->err && answer->kind == BUS_NUMBER)
			TEST_ASSERT_TRUE(answer->number == (n % 2 ? -7.5 : 21.5));
	}
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_it_reads_writes_and_feeds);
	RUN_TEST(test_a_silent_adapter_is_down_within_three_seconds_of_work);
	RUN_TEST(test_one_that_is_pulled_is_down_at_once_and_up_at_another_port);
	RUN_TEST(test_one_that_is_back_and_cannot_be_opened_is_not_called_gone);
	RUN_TEST(test_a_short_is_no_value);
	RUN_TEST(test_transfers_that_fail_make_no_value);
	return UNITY_END();
}
