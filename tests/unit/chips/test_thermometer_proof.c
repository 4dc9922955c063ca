/* SPDX-License-Identifier: MIT */
/*
 * Of which conversion a thermometer's result is, where no chip can show that it converts: what was
 * read last and what was sent since then tell it.
 */
#include <string.h>

#include "hal/chips/find.h"
#include "hal/chips/thermometers/state.h"
#include "hal/chips/thermometers/thermometer_proof.h"
#include "tests/unit/aid/host.h"
#include "unity.h"

#define LONGEST_NS (750 * HOST_MS)

static struct host host;
static const struct link_ops ops;
static struct link wire;
static struct thermometer known;
static struct device device;
static struct txn txn;
static const struct property property = {.convert = CONVERT_TEMPRES};
static int64_t first_ns; /* the end of the conversion that was read */

void setUp(void)
{
	host_init_virtual(&host);
	wire = (struct link){.ops = &ops, .env = &host.env};
	device = (struct device){.rom = {0x28, 1}, .own = &known, .family = family_of(0x28)};
	known = (struct thermometer){.resolution = 12, .stored = 12};
	txn = (struct txn){.link = &wire, .device = &device, .property = &property};
}

void tearDown(void)
{
}

/* Returns when it ends. */
static int64_t converts(void)
{
	int64_t now = host.now;

	thermometer_converts(&device, now, LONGEST_NS, true);
	host.now += 1000 * HOST_MS;
	return now + LONGEST_NS;
}

static void take(uint8_t low)
{
	const uint8_t scratchpad[9] = {low, 1, 0x4b, 0x46, 0x7f, 0xff, 0x10, 0x10};

	thermometer_took(&txn, scratchpad, host.now);
	host.now += 50 * HOST_MS;
}

/* Two results that differ: the second is proven. 0x61 and 0x63 are none of 9 bits. */
static void begin(uint8_t low)
{
	converts();
	take(0x60);
	first_ns = converts();
	take(low);
	TEST_ASSERT_FALSE(txn.unproven);
	TEST_ASSERT_EQUAL_INT64(first_ns, txn.measured_ns);
}

static void test_a_result_that_changed_is_of_the_conversion_since_the_last_reading(void)
{
	begin(0x61);
	int64_t end = converts();

	take(0x63);
	TEST_ASSERT_FALSE(txn.unproven);
	TEST_ASSERT_EQUAL_INT64(end, txn.measured_ns);
}

static void test_the_same_result_is_of_the_conversion_before(void)
{
	begin(0x61);
	for (unsigned i = 0; i < 3; i++)
		converts();
	take(0x61);
	TEST_ASSERT_TRUE(txn.unproven);
	TEST_ASSERT_EQUAL_INT64(first_ns, txn.measured_ns);
}

/* It may have missed all but the first. */
static void test_a_result_that_changed_has_the_time_of_the_first_conversion_since_then(void)
{
	begin(0x61);
	int64_t end = converts();

	converts();
	converts();
	take(0x63);
	TEST_ASSERT_TRUE(txn.unproven);
	TEST_ASSERT_EQUAL_INT64(end, txn.measured_ns);
	/* ... and then of the first since this reading. */
	end = converts();
	converts();
	take(0x65);
	TEST_ASSERT_EQUAL_INT64(end, txn.measured_ns);
}

static void test_the_first_may_be_one_that_nobody_knows_to_have_begun(void)
{
	begin(0x61);
	int64_t told = host.now;

	thermometer_told(&device, told, LONGEST_NS);
	host.now += 1000 * HOST_MS;
	converts();
	take(0x63);
	TEST_ASSERT_TRUE(txn.unproven);
	TEST_ASSERT_EQUAL_INT64(told + LONGEST_NS, txn.measured_ns);
}

static void test_the_first_may_be_one_that_was_under_way_at_the_last_reading(void)
{
	begin(0x61);
	int64_t end = host.now + LONGEST_NS;

	thermometer_converts(&device, host.now, LONGEST_NS, true);
	host.now += 100 * HOST_MS;
	take(0x61);
	host.now += 1000 * HOST_MS;
	converts();
	take(0x63);
	TEST_ASSERT_TRUE(txn.unproven);
	TEST_ASSERT_EQUAL_INT64(end, txn.measured_ns);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_result_that_changed_is_of_the_conversion_since_the_last_reading);
	RUN_TEST(test_the_same_result_is_of_the_conversion_before);
	RUN_TEST(test_a_result_that_changed_has_the_time_of_the_first_conversion_since_then);
	RUN_TEST(test_the_first_may_be_one_that_nobody_knows_to_have_begun);
	RUN_TEST(test_the_first_may_be_one_that_was_under_way_at_the_last_reading);
	return UNITY_END();
}
