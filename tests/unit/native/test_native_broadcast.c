/* SPDX-License-Identifier: MIT */
/* Convert T for all thermometers of a channel, disturbed: what is known of who may have heard. */
#include <errno.h>

#include "unity.h"

#include "hal/chips/thermometers/thermometer_proof.h"
#include "hal/native/convert/broadcast.h"
#include "hal/native/state.h"
#include "tests/unit/aid/native_scene.h"

#define LONGEST_NS (750 * HOST_MS)

static struct native *native;

void setUp(void)
{
	native_begin();
	wire_init(&host, 2, 2);
	for (unsigned i = 0; i < 4; i++)
		wire_add(i % 2, "DS18B20", i + 1);
	start();
	host_run(&host, bus, host.now + 10 * HOST_S);
	native = (struct native *)bus;
}

void tearDown(void)
{
	native_end();
}

/* How many thermometers of the channel may be converting now. */
static unsigned busy(unsigned channel)
{
	unsigned n = 0;

	for (struct device *device = NULL; (device = native_thermometer(native, channel, device));)
		n += thermometer_last(device).busy_ns > native_now(native);
	return n;
}

static int convert(int fault, unsigned times)
{
	TEST_ASSERT_EQUAL_UINT(0, busy(0));
	wire_net.fault = fault;
	wire_net.fault_count = times;
	return broadcast_convert(native, 0, false, LONGEST_NS);
}

static void test_after_a_broadcast_those_of_its_channel_convert_and_no_others(void)
{
	TEST_ASSERT_EQUAL_INT(0, convert(0, 0));
	TEST_ASSERT_EQUAL_UINT(2, busy(0));
	TEST_ASSERT_EQUAL_UINT(0, busy(1));
}

/* Which of them heard cannot be known. What such a chip holds next may be of this conversion. */
static void test_after_a_broadcast_that_failed_they_may_convert_too(void)
{
	static const int errors[] = {-EIO, -ECOMM, -ETIMEDOUT};

	for (unsigned i = 0; i < sizeof(errors) / sizeof(errors[0]); i++) {
		int64_t ends_ns = 0;
		struct device *device = native_thermometer(native, 0, NULL);

		ends_ns = thermometer_last(device).ends_ns;
		TEST_ASSERT_EQUAL_INT(errors[i], convert(errors[i], 1));
		TEST_ASSERT_EQUAL_UINT(2, busy(0));
		TEST_ASSERT_EQUAL_UINT(0, busy(1));
		/* ... and none is known to */
		TEST_ASSERT_EQUAL_INT64(ends_ns, thermometer_last(device).ends_ns);
		host.now += 2 * HOST_S;
	}
}

static void test_a_disturbed_answer_is_asked_for_three_times(void)
{
	TEST_ASSERT_EQUAL_INT(0, convert(-EBADMSG, 2));
	host.now += 2 * HOST_S;
	TEST_ASSERT_EQUAL_INT(-EBADMSG, convert(-EBADMSG, 3));
	TEST_ASSERT_EQUAL_UINT(2, busy(0));
	host.now += 2 * HOST_S;
	TEST_ASSERT_EQUAL_INT(-EIO, convert(-EIO, 1));
	TEST_ASSERT_EQUAL_UINT(0, wire_net.fault_count);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_after_a_broadcast_those_of_its_channel_convert_and_no_others);
	RUN_TEST(test_after_a_broadcast_that_failed_they_may_convert_too);
	RUN_TEST(test_a_disturbed_answer_is_asked_for_three_times);
	return UNITY_END();
}
