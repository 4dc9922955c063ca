/* SPDX-License-Identifier: MIT */
/* Devices of many kinds on the native bus, behind each kind of serial adapter. */
#include <string.h>

#include "unity.h"

#include "hal/native/native.h"
#include "hal/serial/ds2480b.h"
#include "hal/serial/passive.h"
#include "tests/unit/aid/serial_scene.h"

static const char house[] = "chip DS2482-100 0x18\n"
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
	serial_begin();
	bus = NULL;
}

void tearDown(void)
{
	TEST_ASSERT_EQUAL_UINT64(0, serial.sim.overruns);
	if (bus)
		native_destroy(bus);
	serial_end();
}

static const struct bus_answer *ask(enum bus_op op, const char *path, const char *text)
{
	req = (struct bus_req){.id = ++id,
	                       .op = (uint8_t)op,
	                       .prio = BUS_INPUT,
	                       .fresh = true,
	                       .deadline_ns = serial.host.now + 20 * HOST_S,
	                       .path = path,
	                       .len = text ? (uint32_t)strlen(text) : sizeof(data),
	                       .data = data};
	if (text)
		memcpy(data, text, strlen(text));
	serial.host.answers = 0;
	TEST_ASSERT_EQUAL_INT(0, bus_submit(bus, &req));
	TEST_ASSERT_TRUE_MESSAGE(
		host_run_answers(&serial.host, bus, 1, serial.host.now + 30 * HOST_S), path);
	return host_answer(&serial.host, id);
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

static void test_a_ds2480b_reads_writes_and_feeds(void)
{
	static const uint8_t memory[6] = {0xE1, 0xE3, 0xF1, 0xC5, 0xE3, 0xE3};

	bus = serial_bus_of(SIM_DS2480B, &serial_ds2480b, house);
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

static void test_a_passive_adapter_reads_and_writes(void)
{
	bus = serial_bus_of(SIM_PASSIVE, &serial_passive, house);
	read_all();
	TEST_ASSERT_NOT_EQUAL_INT(0, ask(BUS_READ, "/28.0000000000E7/temperature", NULL)->err);
	TEST_ASSERT_EQUAL_INT(0, ask(BUS_WRITE, "/3A.0000000000E5/PIO.ALL", "1,0")->err);
	expect("/3A.0000000000E5/PIO.ALL", "1,0");
}

static void test_a_silent_adapter_is_down_within_three_seconds_of_work(void)
{
	int64_t begun;

	bus = serial_bus_of(SIM_DS2480B, &serial_ds2480b, house);
	serial.sim.silent = true;
	begun = serial.host.now;
	TEST_ASSERT_NOT_EQUAL_INT(0, ask(BUS_READ, readings[3].path, NULL)->err);
	TEST_ASSERT_LESS_THAN_INT64(3 * HOST_S, serial.host.now - begun);
	host_run(&serial.host, bus, serial.host.now + HOST_S);
	TEST_ASSERT_EQUAL_UINT(1, host_events(&serial.host, BUS_DOWN));
	serial.sim.silent = false;
	host_run(&serial.host, bus, serial.host.now + 2 * HOST_S);
	TEST_ASSERT_EQUAL_UINT(2, host_events(&serial.host, BUS_UP));
	read_all();
}

/* Each value is the true one, or an error. */
static void test_noise_on_the_line_makes_no_value(void)
{
	bus = serial_bus_of(SIM_DS2480B, &serial_ds2480b, house);
	for (unsigned each = 11; each < 200; each += 17) {
		serial.sim.noise_each = each;
		for (unsigned i = 0; i < 10; i++) {
			const struct bus_answer *answer = ask(BUS_READ, readings[i % 2].path, NULL);

			if (answer && !answer->err && answer->kind == BUS_NUMBER)
				TEST_ASSERT_TRUE(answer->number == (i % 2 ? -7.5 : 21.5));
		}
	}
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_ds2480b_reads_writes_and_feeds);
	RUN_TEST(test_a_passive_adapter_reads_and_writes);
	RUN_TEST(test_a_silent_adapter_is_down_within_three_seconds_of_work);
	RUN_TEST(test_noise_on_the_line_makes_no_value);
	return UNITY_END();
}
