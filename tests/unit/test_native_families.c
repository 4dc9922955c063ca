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
static struct bus_req req;
static uint8_t data[2048];
static char path[128];
static struct sim_slave *slave;
static uint32_t next_id;

void setUp(void)
{
	host_init_virtual(&host);
}

void tearDown(void)
{
	bus_destroy(bus);
	bus = NULL;
	wire_clear();
}

static void start(const char *chip)
{
	wire_init(&host, 1, 1);
	slave = wire_add(0, chip, 1);
	wire_add(0, "DS18B20", 2);
	bus = wire_open();
	TEST_ASSERT_TRUE(host_run_events(&host, bus, 1, host.now + HOST_S));
}

static const struct bus_answer *go(enum bus_op op, const char *property, const char *text)
{
	char name[ROM_TEXT_MAX];
	uint32_t id = next_id++;

	rom_print(slave->rom, ROM_F_I, name);
	snprintf(path, sizeof(path), "/%s/%s", name, property);
	req = (struct bus_req){.id = id, .op = (uint8_t)op, .prio = BUS_OUTPUT, .fresh = true,
	                       .path = path, .data = data, .len = sizeof(data) - 1,
	                       .deadline_ns = host.now + 20 * HOST_S};
	if (text) {
		req.len = (uint32_t)strlen(text);
		memcpy(data, text, req.len);
	}
	host.answers = 0;
	TEST_ASSERT_EQUAL_INT(0, bus_submit(bus, &req));
	TEST_ASSERT_TRUE(host_run_answers(&host, bus, 1, host.now + 21 * HOST_S));
	TEST_ASSERT_EQUAL_UINT(1, host.answers);
	return &host.answer[0];
}

static void reads(const char *property, const char *text)
{
	const struct bus_answer *answer = go(BUS_READ, property, NULL);

	TEST_ASSERT_EQUAL_INT_MESSAGE(0, answer->err, property);
	data[answer->len] = '\0';
	TEST_ASSERT_EQUAL_STRING_MESSAGE(text, (char *)data, property);
}

static void writes(const char *property, const char *text)
{
	const struct bus_answer *answer = go(BUS_WRITE, property, text);

	TEST_ASSERT_EQUAL_INT_MESSAGE(0, answer->err, property);
	TEST_ASSERT_EQUAL_UINT_MESSAGE(strlen(text), answer->len, property);
}

static void refuses(int err, enum bus_op op, const char *property, const char *text)
{
	TEST_ASSERT_EQUAL_INT_MESSAGE(err, go(op, property, text)->err, property);
}

static void test_a_ds2408_switches_and_keeps_its_neighbours(void)
{
	start("DS2408");
	reads("por", "1");
	writes("por", "0");
	reads("por", "0");
	writes("PIO.BYTE", "170");
	reads("PIO.BYTE", "         170");
	reads("PIO.ALL", "0,1,0,1,0,1,0,1");
	writes("PIO.0", "1");
	writes("PIO.7", "off");
	reads("PIO.BYTE", "          43");
	reads("sensed.BYTE", "         212");
	writes("PIO.ALL", "0,0,0,0,0,0,0,0");
	reads("PIO.BYTE", "           0");
	writes("latch.BYTE", "0");
	reads("latch.BYTE", "           0");
	writes("set_alarm", "133333333");
	reads("set_alarm", "   133333333");
	writes("set_alarm", "322000001");
	reads("set_alarm", "   322000001");
	reads("por", "0");
	writes("strobe", "1");
	reads("strobe", "1");
	writes("out_of_testmode", "1");
	refuses(-EINVAL, BUS_WRITE, "PIO.ALL", "1,0,1");
	refuses(-EINVAL, BUS_WRITE, "PIO.0", "maybe");
	refuses(-ENOENT, BUS_READ, "PIO", NULL);
	refuses(-ENOENT, BUS_READ, "PIO.8", NULL);
	refuses(-ENOENT, BUS_READ, "PIO.A", NULL);
}

static void test_a_ds2408_that_restarts_is_told(void)
{
	start("DS2408");
	writes("por", "0");
	writes("PIO.BYTE", "15");
	sim_slave_power_on(slave, host.now);
	reads("sensed.BYTE", "         255");
	TEST_ASSERT_EQUAL_UINT(1, host_events(&host, BUS_POR));
	reads("por", "1");
	TEST_ASSERT_EQUAL_UINT(1, host_events(&host, BUS_POR));
}

static void test_a_ds2413_switches(void)
{
	start("DS2413");
	reads("PIO.BYTE", "           0");
	writes("PIO.B", "1");
	reads("PIO.BYTE", "           2");
	reads("PIO.ALL", "0,1");
	reads("sensed.BYTE", "           1");
	writes("PIO.BYTE", "3");
	reads("sensed.ALL", "0,0");
	refuses(-EACCES, BUS_WRITE, "sensed.A", "1");
}

static void test_a_ds28ea00_measures_and_switches(void)
{
	start("DS28EA00");
	wire_set(slave, "temperature", 33.5);
	reads("temperature", "        33.5");
	writes("PIO.A", "1");
	reads("PIO.BYTE", "           1");
	reads("latch.BYTE", "           2");
	reads("temperature9", "        33.5");
}

static void test_a_ds1825_has_its_place(void)
{
	start("DS1825");
	wire_set(slave, "temperature", -7.25);
	reads("temperature", "       -7.25");
	reads("type", "DS1825");
	reads("prog_addr", "           0");
	refuses(-ENOENT, BUS_READ, "thermocouple", NULL);
	writes("templow", "-20");
	reads("templow", "         -20");
}

static void test_a_ds18s20_resolves_sixteenths(void)
{
	start("DS18S20");
	for (int i = -8; i <= 8; i++) {
		char text[16];

		wire_set(slave, "temperature", i / 16.0 + 1);
		snprintf(text, sizeof(text), "%12G", i / 16.0 + 1);
		reads("temperature", text);
	}
}

static void test_a_ds2438_measures_and_keeps_time(void)
{
	start("DS2438");
	reads("VDD", "           5");
	reads("VAD", "           0");
	reads("temperature", "          20");
	writes("udate", "1000000000");
	const struct bus_answer *answer = go(BUS_READ, "udate", NULL);
	TEST_ASSERT_EQUAL_INT(0, answer->err);
	TEST_ASSERT_DOUBLE_WITHIN(5, 1000000000, answer->number);
	writes("offset", "-5");
	reads("offset", "  4294967291");
	reads("IAD", "1");
	writes("IAD", "0");
	reads("IAD", "0");
	reads("vis", "           0");
	reads("IAD", "0");
	refuses(-EINVAL, BUS_WRITE, "offset", "1000");
	writes("pages/page.4", "abcdefgh");
	reads("pages/page.4", "abcdefgh");
	writes("B1-R1-A/gain", "30.5");
	reads("B1-R1-A/gain", "        30.5");
	reads("B1-R1-A/pressure", "       904.7");
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_ds2408_switches_and_keeps_its_neighbours);
	RUN_TEST(test_a_ds2408_that_restarts_is_told);
	RUN_TEST(test_a_ds2413_switches);
	RUN_TEST(test_a_ds28ea00_measures_and_switches);
	RUN_TEST(test_a_ds1825_has_its_place);
	RUN_TEST(test_a_ds18s20_resolves_sixteenths);
	RUN_TEST(test_a_ds2438_measures_and_keeps_time);
	return UNITY_END();
}
