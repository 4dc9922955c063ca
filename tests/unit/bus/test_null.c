/* SPDX-License-Identifier: MIT */
/* Tests of the null bus. */
#include <errno.h>
#include <string.h>

#include "unity.h"

#include "tests/unit/aid/host.h"

static struct host host;
static struct bus *bus;
static uint8_t data[128];

void setUp(void)
{
	host_init_virtual(&host);
	bus = host_bus(&host, "null:");
}

void tearDown(void)
{
	bus_destroy(bus);
}

static const struct bus_answer *ask(enum bus_op op, const char *path, const char *text,
                                    uint32_t len)
{
	static uint32_t id;
	struct bus_req req = {.id = ++id,
	                      .op = (uint8_t)op,
	                      .path = path,
	                      .data = data,
	                      .len = len,
	                      .deadline_ns = INT64_MAX};

	if (text)
		memcpy(data, text, len);
	TEST_ASSERT_EQUAL_INT(0, bus_submit(bus, &req));
	bus_step(bus, host.now);
	TEST_ASSERT_EQUAL_UINT(1, host_answers(&host, id));
	return host_answer(&host, id);
}

static void test_a_read_gives_what_was_written(void)
{
	const struct bus_answer *answer = ask(BUS_WRITE, "/29.000000000002/PIO.BYTE", "137", 3);

	TEST_ASSERT_EQUAL_INT(0, answer->err);
	TEST_ASSERT_EQUAL_UINT32(3, answer->len);
	answer = ask(BUS_READ, "/29.000000000002/PIO.BYTE", NULL, sizeof(data));
	TEST_ASSERT_EQUAL_INT(0, answer->err);
	TEST_ASSERT_EQUAL_UINT32(3, answer->len);
	TEST_ASSERT_EQUAL_MEMORY("137", data, 3);
	TEST_ASSERT_EQUAL_UINT8(BUS_DETAIL_SIMULATED, answer->detail);
	TEST_ASSERT_EQUAL_INT64(host.now, answer->measured_ns);
}

static void test_the_root_lists_each_device_once(void)
{
	const struct bus_answer *answer = ask(BUS_DIR, "/", NULL, sizeof(data));
	const char *expected = "/28.000000000001\n/29.000000000002\n";

	TEST_ASSERT_EQUAL_INT(0, answer->err);
	TEST_ASSERT_EQUAL_UINT32(strlen(expected), answer->len);
	TEST_ASSERT_EQUAL_MEMORY(expected, data, strlen(expected));
}

static void test_a_device_lists_its_properties(void)
{
	const struct bus_answer *answer = ask(BUS_DIR, "/28.000000000001", NULL, sizeof(data));
	const char *expected = "/28.000000000001/address\n/28.000000000001/temperature\n";

	TEST_ASSERT_EQUAL_INT(0, answer->err);
	TEST_ASSERT_EQUAL_UINT32(strlen(expected), answer->len);
	TEST_ASSERT_EQUAL_MEMORY(expected, data, strlen(expected));
}

static void test_it_says_that_it_has_no_alarm_search(void)
{
	const struct bus_answer *answer = ask(BUS_DIR, "/alarm", NULL, sizeof(data));

	TEST_ASSERT_EQUAL_INT(-EOPNOTSUPP, answer->err);
	TEST_ASSERT_EQUAL_UINT32(0, answer->len);
}

static void test_device_and_property_are_missed_by_different_errors(void)
{
	TEST_ASSERT_EQUAL_INT(-ENODEV, ask(BUS_READ, "/28.FFFFFFFFFFFF/type", NULL, 64)->err);
	TEST_ASSERT_EQUAL_INT(-ENOENT, ask(BUS_READ, "/28.000000000001/colour", NULL, 64)->err);
	TEST_ASSERT_EQUAL_INT(-ENODEV, ask(BUS_PROBE, "/28.FFFFFFFFFFFF", NULL, 0)->err);
	TEST_ASSERT_EQUAL_INT(0, ask(BUS_PROBE, "/28.000000000001/temperature", NULL, 0)->err);
	TEST_ASSERT_EQUAL_INT(-ENODEV, ask(BUS_DIR, "/28.FFFFFFFFFFFF", NULL, 64)->err);
	TEST_ASSERT_EQUAL_INT(-ENODEV, ask(BUS_DIR, "/28.000000000001x", NULL, 64)->err);
	TEST_ASSERT_EQUAL_INT(-ENOTDIR,
	                      ask(BUS_DIR, "/28.000000000001/temperature", NULL, 64)->err);
}

static void test_too_little_room_is_an_error_and_writes_nothing(void)
{
	memset(data, 'x', sizeof(data));
	TEST_ASSERT_EQUAL_INT(-EMSGSIZE, ask(BUS_READ, "/28.000000000001/address", NULL, 15)->err);
	TEST_ASSERT_EQUAL_UINT8('x', data[0]);
	TEST_ASSERT_EQUAL_INT(-EMSGSIZE, ask(BUS_DIR, "/", NULL, 33)->err);
	TEST_ASSERT_EQUAL_UINT8('x', data[33]);
}

static void test_a_value_longer_than_its_place_is_refused(void)
{
	char text[65];

	memset(text, '1', sizeof(text));
	TEST_ASSERT_EQUAL_INT(0, ask(BUS_WRITE, "/29.000000000002/PIO.BYTE", text, 64)->err);
	TEST_ASSERT_EQUAL_INT(-EINVAL, ask(BUS_WRITE, "/29.000000000002/PIO.BYTE", text, 65)->err);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_read_gives_what_was_written);
	RUN_TEST(test_the_root_lists_each_device_once);
	RUN_TEST(test_a_device_lists_its_properties);
	RUN_TEST(test_it_says_that_it_has_no_alarm_search);
	RUN_TEST(test_device_and_property_are_missed_by_different_errors);
	RUN_TEST(test_too_little_room_is_an_error_and_writes_nothing);
	RUN_TEST(test_a_value_longer_than_its_place_is_refused);
	return UNITY_END();
}
