/* SPDX-License-Identifier: MIT */
/* One DS2482 of several does not answer: what is behind it is not called absent, and comes back. */
#include <errno.h>
#include <string.h>

#include "unity.h"

#include "tests/unit/aid/one_bus.h"

static struct bus_req req;
static uint8_t text[64];
static uint32_t ids;

void setUp(void)
{
	ids = 0;
}

void tearDown(void)
{
	one_bus_end();
}

static int result(const char *path)
{
	req = (struct bus_req){.id = ids++,
	                       .op = BUS_READ,
	                       .prio = BUS_INPUT,
	                       .fresh = true,
	                       .path = path,
	                       .data = text,
	                       .len = sizeof(text),
	                       .deadline_ns = host.now + 10 * HOST_S};
	host.answers = 0;
	TEST_ASSERT_EQUAL_INT(0, bus_submit(bus, &req));
	TEST_ASSERT_TRUE(host_run_answers(&host, bus, 1, host.now + 11 * HOST_S));
	return host.answer[0].err;
}

static bool is_noted(const char *what)
{
	for (unsigned i = 0; i < host.events; i++)
		if (host.event[i].news == BUS_NOTE && strstr(host.event[i].text, what))
			return true;
	return false;
}

#define FIRST "/28.0000000000A1/temperature9"
#define SECOND "/28.0000000000A2/temperature9"
#define NOWHERE "/28.0000000000A3/temperature9"

/* Whichever it is: the channels of the others have other numbers meanwhile if it is the first. */
static void check(const char *scenario, const char *lost, const char *kept)
{
	int64_t back;

	simulate(scenario);
	int64_t zero = host.now;
	host_run(&host, bus, zero + 5 * HOST_S);
	TEST_ASSERT_EQUAL_INT(0, result(FIRST));
	TEST_ASSERT_EQUAL_INT(0, result(SECOND));
	TEST_ASSERT_EQUAL_INT(-ENODEV, result(NOWHERE));
	host_run(&host, bus, zero + 30 * HOST_S);
	(void)result(lost); /* the first may fail on the way */
	for (unsigned i = 0; i < 5; i++) {
		host_run(&host, bus, host.now + HOST_S);
		TEST_ASSERT_EQUAL_INT(-ENXIO, result(lost));
		TEST_ASSERT_EQUAL_INT(-ENXIO, result(NOWHERE));
		TEST_ASSERT_EQUAL_INT(0, result(kept));
	}
	TEST_ASSERT_TRUE(is_noted("no DS2482 answers at 0x1"));
	back = zero + 70 * HOST_S;
	TEST_ASSERT_LESS_THAN_INT64(back, host.now);
	host_run(&host, bus, back + 11 * HOST_S);
	TEST_ASSERT_EQUAL_INT(0, result(lost));
	TEST_ASSERT_EQUAL_INT(0, result(kept));
	TEST_ASSERT_EQUAL_INT(-ENODEV, result(NOWHERE));
	one_bus_end();
}

#define PLANT \
	"chip DS2482-100 0x18\nDS18B20 28.0000000000A1\n" \
	"chip DS2482-100 0x19\nDS18B20 28.0000000000A2\n"

static void test_a_chip_that_does_not_answer_is_no_absence(void)
{
	check(PLANT "at 30s refuse 0x19\nat 70s end refuse 0x19\n", SECOND, FIRST);
	check(PLANT "at 30s refuse 0x18\nat 70s end refuse 0x18\n", FIRST, SECOND);
}

/* Out for a moment: it is looked for after a second, not after ten. */
static void test_a_chip_that_was_out_for_a_moment_is_back_soon(void)
{
	simulate(PLANT "at 30s refuse 0x19\nat 31s end refuse 0x19\n");
	int64_t zero = host.now;
	host_run(&host, bus, zero + 30 * HOST_S);
	while (host.now < zero + 31 * HOST_S)
		(void)result(SECOND);
	host_run(&host, bus, zero + 34 * HOST_S);
	TEST_ASSERT_EQUAL_INT(0, result(SECOND));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_chip_that_does_not_answer_is_no_absence);
	RUN_TEST(test_a_chip_that_was_out_for_a_moment_is_back_soon);
	return UNITY_END();
}
