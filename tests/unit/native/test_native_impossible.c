/* SPDX-License-Identifier: MIT */
/* A chip that answers, under a right checksum, what it cannot have measured. */
#include <errno.h>
#include <string.h>

#include "unity.h"

#include "tests/unit/aid/native_scene.h"

void setUp(void)
{
	native_begin();
}

void tearDown(void)
{
	native_end();
}

static void refused(bool fresh, const char *path, double number)
{
	const struct bus_answer *answer = answer_to(ask(BUS_READ, BUS_GUEST, fresh, path, NULL));

	TEST_ASSERT_EQUAL_INT_MESSAGE(-EDOM, answer->err, path);
	TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(0.5, number, answer->number, path);
	TEST_ASSERT_EQUAL_UINT32_MESSAGE(0, answer->len, path);
}

static void test_a_temperature_that_no_chip_measures_is_refused_at_each_resolution(void)
{
	static const char *const chips[] = {"DS18B20", "DS18S20",  "DS1822",
	                                    "DS1825",  "DS28EA00", "DS18B20-B1"};
	static const char *const properties[] = {"temperature",   "temperature9",  "temperature10",
	                                         "temperature11", "temperature12", "fasttemp",
	                                         "latesttemp"};
	static const double lies[] = {-109.9375, -58.5, -128};

	for (size_t c = 0; c < sizeof(chips) / sizeof(chips[0]); c++) {
		wire_init(&host, 1, 1);
		struct sim_slave *slave = wire_add(0, chips[c], 1);

		start();
		for (size_t p = 0; p < sizeof(properties) / sizeof(properties[0]); p++)
			for (size_t i = 0; i < sizeof(lies) / sizeof(lies[0]); i++) {
				const char *path = of(slave, properties[p]);

				wire_set(slave, "temperature", 21.5);
				TEST_ASSERT_EQUAL_INT_MESSAGE(
					0, result(BUS_READ, of(slave, "temperature"), NULL), path);
				wire_set(slave, "temperature", lies[i]);
				if (strcmp(properties[p], "latesttemp") == 0)
					refused(true, of(slave, "temperature"), lies[i]);
				refused(true, path, lies[i]);
				/* what was kept of the good reading is over, and no lie is kept */
				host_run(&host, bus, host.now + 3 * HOST_S);
				refused(false, path, lies[i]);
				forget();
			}
		native_end();
		native_begin();
	}
	wire_init(&host, 1, 1);
	start();
}

static void test_what_stands_in_the_chip_can_be_read_all_the_same(void)
{
	wire_init(&host, 1, 1);
	struct sim_slave *slave = wire_add(0, "DS18B20", 1);

	wire_set(slave, "temperature", -109.9375);
	start();
	refused(true, of(slave, "temperature"), -109.9375);
	const struct bus_answer *raw = answer_to(
		ask(BUS_READ, BUS_GUEST, true, of(slave, "scratchpad"), NULL));
	TEST_ASSERT_EQUAL_INT(0, raw->err);
	TEST_ASSERT_EQUAL_UINT32(9, raw->len);
}

/* 76 V and a humidity of a board without its sensor: by the supply, or by what it is divided by. */
static void test_a_converter_without_its_sensor_has_no_humidity(void)
{
	static const char *const humidities[] = {"humidity", "HIH3600/humidity", "HIH4000/humidity",
	                                         "HTM1735/humidity"};
	static const double volts[] = {0.001, 9};

	wire_init(&host, 1, 1);
	struct sim_slave *slave = wire_add(0, "DS2438", 1);

	start();
	for (size_t v = 0; v < sizeof(volts) / sizeof(volts[0]); v++)
		for (size_t i = 0; i < sizeof(humidities) / sizeof(humidities[0]); i++) {
			const char *path = of(slave, humidities[i]);

			wire_set(slave, "vad", volts[v]);
			TEST_ASSERT_EQUAL_INT_MESSAGE(-EDOM, result(BUS_READ, path, NULL), path);
			TEST_ASSERT_EQUAL_INT(0, result(BUS_READ, of(slave, "VAD"), NULL));
			wire_set(slave, "vad", 2.5);
			TEST_ASSERT_EQUAL_INT_MESSAGE(0, result(BUS_READ, path, NULL), path);
		}
}

/* Its humidity is computed from its temperature, and is none then either. */
static void test_a_converter_whose_temperature_cannot_be_has_none_and_no_humidity(void)
{
	static const char *const chips[] = {"DS2438", "DS2438-A6", "DS2437", "DS2438-EMULATED"};

	for (size_t c = 0; c < sizeof(chips) / sizeof(chips[0]); c++) {
		wire_init(&host, 1, 1);
		struct sim_slave *slave = wire_add(0, chips[c], 1);

		wire_set(slave, "vad", 2.5);
		wire_set(slave, "temperature", -109.5);
		start();
		refused(true, of(slave, "temperature"), -109.5);
		refused(true, of(slave, "latesttemp"), -109.5);
		if (strcmp(chips[c], "DS2437") != 0)
			refused(true, of(slave, "HIH4000/humidity"), -109.5);
		TEST_ASSERT_EQUAL_INT(0, result(BUS_READ, of(slave, "VAD"), NULL));
		native_end();
		native_begin();
	}
	wire_init(&host, 1, 1);
	start();
}

/* It has answered: what failed before does not take the second try of what comes after. */
static void test_a_refused_reading_ends_the_failures_of_its_chip(void)
{
	struct trouble trouble;

	trouble_none(&trouble);
	wire_init(&host, 1, 1);
	wire_net.trouble = &trouble;
	struct sim_slave *slave = wire_add(0, "DS18B20", 1);

	start();
	wire_set(slave, "temperature", -109.9375);
	slave->corrupt_every = 1;
	slave->corrupt_random = 7;
	for (unsigned i = 0; i < 5; i++)
		TEST_ASSERT_EQUAL_INT(-EBADMSG, result(BUS_READ, of(slave, "scratchpad"), NULL));
	slave->corrupt_every = 0;
	refused(true, of(slave, "temperature"), -109.9375);
	trouble_none(&trouble);
	trouble.kind = TROUBLE_TURN;
	trouble.at = 85; /* in the first byte of the scratchpad */
	trouble.mask = 1;
	TEST_ASSERT_EQUAL_INT(0, result(BUS_READ, of(slave, "scratchpad"), NULL));
	TEST_ASSERT_GREATER_THAN_UINT32(2 * 85, trouble.slots);
	wire_net.trouble = NULL;
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_temperature_that_no_chip_measures_is_refused_at_each_resolution);
	RUN_TEST(test_what_stands_in_the_chip_can_be_read_all_the_same);
	RUN_TEST(test_a_converter_without_its_sensor_has_no_humidity);
	RUN_TEST(test_a_converter_whose_temperature_cannot_be_has_none_and_no_humidity);
	RUN_TEST(test_a_refused_reading_ends_the_failures_of_its_chip);
	return UNITY_END();
}
