/* SPDX-License-Identifier: MIT */
/*
 * A result that was read with those of other chips before the longest time of its conversion, and
 * is judged after that time: the moment of the reading counts.
 */
#include <string.h>

#include "hal/chips/find.h"
#include "hal/chips/thermometers/state.h"
#include "hal/chips/thermometers/thermometer.h"
#include "hal/sim/crc.h"
#include "tests/unit/aid/host.h"
#include "unity.h"

static struct host host;
static const struct link_ops ops;
static struct link wire;
static struct thermometer known;
static struct device device;
static struct txn txn;
static const struct property property = {.convert = CONVERT_TEMPRES};
static uint8_t out[10] = {0x55, 0x28, 1, 0, 0, 0, 0, 0, 0, 0xbe};
static uint8_t in[9] = {0x60, 0x01, 0x4b, 0x46, 0x7f, 0xff, 0x10, 0x10};
static struct link_run run;

void setUp(void)
{
	host_init_virtual(&host);
	wire = (struct link){.ops = &ops, .env = &host.env};
	device = (struct device){.rom = {0x28, 1}, .own = &known, .family = family_of(0x28)};
	TEST_ASSERT_NOT_NULL(device.family);
	/* It ended 650 ms after its start, as it seemed, and at the latest after 750 ms. */
	known = (struct thermometer){.resolution = 12,
	                             .stored = 12,
	                             .shows = true,
	                             .longest_ns = 750 * HOST_MS,
	                             .early_ns = host.now - 50 * HOST_MS,
	                             .converted_ns = host.now + 50 * HOST_MS,
	                             .busy_ns = host.now + 50 * HOST_MS,
	                             .least_ns = host.now + 50 * HOST_MS};
	in[8] = sim_crc8(0, in, 8);
	run = (struct link_run){.part = {.reset = true,
	                                 .out = out,
	                                 .out_n = sizeof(out),
	                                 .in = in,
	                                 .in_n = sizeof(in)},
	                        .ended_ns = host.now};
	txn = (struct txn){.link = &wire, .device = &device, .property = &property};
	txn_done(&txn, &run);
}

void tearDown(void)
{
}

/* Other steps took so long. */
static void judged_later_by(int64_t ns)
{
	host.now += ns;
}

static void test_what_nothing_proves_is_not_good_for_being_judged_late(void)
{
	judged_later_by(60 * HOST_MS);
	TEST_ASSERT_EQUAL_INT(TXN_MORE, thermometer_read_temperature(&txn));
	TEST_ASSERT_GREATER_OR_EQUAL_INT64(known.converted_ns, txn.wake_ns);
}

static void test_what_was_read_after_the_longest_time_is_good(void)
{
	run.ended_ns = known.converted_ns;
	judged_later_by(60 * HOST_MS);
	TEST_ASSERT_EQUAL_INT(0, thermometer_read_temperature(&txn));
	TEST_ASSERT_EQUAL_DOUBLE(22.0, txn.number[0]);
	TEST_ASSERT_EQUAL_INT64(run.ended_ns, known.raw_ns);
}

static void test_another_value_proves_the_end_and_counts_from_its_reading(void)
{
	known.proves = true;
	known.latched[0] = 0x50;
	judged_later_by(60 * HOST_MS);
	TEST_ASSERT_EQUAL_INT(0, thermometer_read_temperature(&txn));
	TEST_ASSERT_EQUAL_INT64(run.ended_ns, known.raw_ns);
	TEST_ASSERT_LESS_OR_EQUAL_INT64(run.ended_ns, txn.measured_ns);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_what_nothing_proves_is_not_good_for_being_judged_late);
	RUN_TEST(test_what_was_read_after_the_longest_time_is_good);
	RUN_TEST(test_another_value_proves_the_end_and_counts_from_its_reading);
	return UNITY_END();
}
