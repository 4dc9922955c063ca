/* SPDX-License-Identifier: MIT */
/* Tests of the health of devices: what qualities, simulation and failed requests say of them. */
#include "unity.h"

#include "src/faces/show/stats.h"
#include "tests/unit/aid/instance.h"

#define S INSTANCE_S

static const struct instance_signal signals[] = {
	{"room", "/28.551DDF030000/temperature", OWS_DOUBLE, false, 10 * S,
         .device = "28.551DDF030000"},
	{"valve", "/3A.8D2A04000000/PIO.A", OWS_BOOL, true, 0, .device = "3A.8D2A04000000"},
	{"title", "/28.1/type", OWS_STRING, false, 0},
};

void setUp(void)
{
}
void tearDown(void)
{
}

static void test_each_quality_has_one_of_the_words(void)
{
	static const struct {
		uint8_t quality;
		const char *word;
	} rows[] = {
		{OWS_Q_GOOD, "normal"},
		{0xd8, "normal"},
		{OWS_Q_NO_DEVICE, "failure"},
		{OWS_Q_SHORT, "failure"},
		{OWS_Q_DISABLED, "check function"},
		{OWS_Q_RANGE, "off spec"},
		{OWS_Q_NO_OWSD, "check function"},
		{0x00, "failure"},
	};

	for (size_t i = 0; i < sizeof(rows) / sizeof(rows[0]); i++)
		TEST_ASSERT_EQUAL_STRING(rows[i].word,
		                         health_word(quality_health(rows[i].quality)));
	TEST_ASSERT_EQUAL_STRING("maintenance required", health_word(HEALTH_MAINTENANCE));
}

static void test_what_is_simulated_is_checked_and_what_nobody_has_set_is_normal(void)
{
	struct ows_info input = {.path = "/28.1/temperature", .device = "28.1"};
	struct ows_info output = {.path = "/3A.1/PIO.A", .device = "3A.1", .output = 1};
	struct ows_info key = {.path = "/01.7A3B4C5D6E7F/present", .device = "01.7A3B4C5D6E7F"};

	TEST_ASSERT_EQUAL(HEALTH_NORMAL, health_of_signal(&input, OWS_Q_GOOD, false));
	TEST_ASSERT_EQUAL(HEALTH_CHECK, health_of_signal(&input, OWS_Q_GOOD, true));
	TEST_ASSERT_EQUAL(HEALTH_FAILURE, health_of_signal(&input, OWS_Q_NO_DEVICE, true));
	TEST_ASSERT_EQUAL(HEALTH_CHECK, health_of_signal(&input, OWS_Q_INITIAL, false));
	TEST_ASSERT_EQUAL(HEALTH_NORMAL, health_of_signal(&output, OWS_Q_INITIAL, false));
	TEST_ASSERT_EQUAL(HEALTH_NORMAL, health_of_signal(&key, OWS_Q_NO_DEVICE, false));
}

static void test_errors_ask_for_maintenance_from_a_thousand_requests_on(void)
{
	struct ows_device device = {.answers = 999, .errors = 500};

	TEST_ASSERT_EQUAL(HEALTH_NORMAL, health_of_wire(&device));
	device.answers = 1000;
	TEST_ASSERT_EQUAL(HEALTH_MAINTENANCE, health_of_wire(&device));
	device.errors = 10;
	TEST_ASSERT_EQUAL(HEALTH_NORMAL, health_of_wire(&device));
	device.errors = 11;
	TEST_ASSERT_EQUAL(HEALTH_MAINTENANCE, health_of_wire(&device));
}

static void test_the_worst_is_the_one_that_counts(void)
{
	static const enum device_health order[] = {HEALTH_NORMAL, HEALTH_MAINTENANCE,
	                                           HEALTH_OFF_SPEC, HEALTH_CHECK, HEALTH_FAILURE};
	int count = sizeof(order) / sizeof(order[0]);

	for (int a = 0; a < count; a++)
		for (int b = 0; b < count; b++)
			TEST_ASSERT_EQUAL(order[a > b ? a : b], health_worse(order[a], order[b]));
}

static void test_a_device_has_the_health_of_its_signals(void)
{
	struct instance in;
	struct ows_device device;
	enum device_health healths[2];
	struct ows *ows;
	int64_t now_ns = ows_now();

	instance_start(&in, "health", signals, 3);
	TEST_ASSERT_EQUAL_INT(0, ows_open(in.name, OWS_READ, &ows));
	instance_put_double(&in, 1, 21.5, now_ns);
	instance_put(&in, 2, 1, now_ns);
	TEST_ASSERT_EQUAL_INT(0, health_find(ows, "28.551ddf030000", &device));
	TEST_ASSERT_EQUAL_INT(1, health_find(ows, "3A.8D2A04000000", &device));
	TEST_ASSERT_EQUAL_INT(-1, health_find(ows, "3A.8D2A04000001", &device));
	health_devices(ows, now_ns, healths, 2);
	TEST_ASSERT_EQUAL(HEALTH_NORMAL, healths[0]);
	TEST_ASSERT_EQUAL(HEALTH_NORMAL, healths[1]);
	/* stale */
	health_devices(ows, now_ns + 11 * S, healths, 2);
	TEST_ASSERT_EQUAL(HEALTH_FAILURE, healths[0]);
	TEST_ASSERT_EQUAL(HEALTH_NORMAL, healths[1]);
	ows_close(ows);
	instance_end(&in);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_each_quality_has_one_of_the_words);
	RUN_TEST(test_what_is_simulated_is_checked_and_what_nobody_has_set_is_normal);
	RUN_TEST(test_errors_ask_for_maintenance_from_a_thousand_requests_on);
	RUN_TEST(test_the_worst_is_the_one_that_counts);
	RUN_TEST(test_a_device_has_the_health_of_its_signals);
	return UNITY_END();
}
