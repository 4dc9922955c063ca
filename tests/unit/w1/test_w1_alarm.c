/* SPDX-License-Identifier: MIT */
/* Tests of alarms over the kernel's 1-Wire drivers. */
#include <errno.h>

#include "unity.h"

#include "tests/unit/aid/fs_scene.h"

void setUp(void)
{
	fs_begin();
}

void tearDown(void)
{
	fs_end();
}

static void test_a_thermometer_beyond_its_limits_is_in_alarm(void)
{
	fs_thermometer(WARM, 0x151);
	fs_thermometer("28-0000000000a2", 0x151);
	fs_scratchpad(WARM, 0x151, 22, 20, 0x7f, "YES");
	fs_scratchpad("28-0000000000a2", 0x151, 21, 20, 0x7f, "YES");
	fs_start();
	fs_lists("/alarm/28.A20000000000\n", "/alarm/28");
	fs_scratchpad(WARM, -8 & 0xffff, 22, -1, 0x7f, "YES");
	fs_reads("        -0.5", WARM_OW "/temperature");
	fs_lists("/alarm" WARM_OW "\n/alarm/28.A20000000000\n", "/alarm/28");
}

static void test_thermometers_asked_for_their_alarm_convert_at_once(void)
{
	fs_thermometer(WARM, 0x151);
	fs_text("w1_bus_master1", "therm_bulk_read", "0\n");
	fs_start();
	fs_lists("/alarm" WARM_OW "\n", "/alarm/28");
	/* One alone is read. */
	TEST_ASSERT_EQUAL_STRING("0\n", fs_now_in("w1_bus_master1", "therm_bulk_read"));
	fs_thermometer("28-0000000000a2", 0x151);
	host_run(&fs.host, fs.bus, fs.host.now + 11 * HOST_S);
	fs_lists("/alarm" WARM_OW "\n/alarm/28.A20000000000\n", "/alarm/28");
	TEST_ASSERT_EQUAL_STRING("trigger\n", fs_now_in("w1_bus_master1", "therm_bulk_read"));
	fs_text("w1_bus_master1", "therm_bulk_read", "0\n");
	fs_lists("/alarm" WARM_OW "\n/alarm/28.A20000000000\n", "/alarm/28");
	TEST_ASSERT_EQUAL_STRING("0\n", fs_now_in("w1_bus_master1", "therm_bulk_read"));
}

static void test_a_ds2408_is_in_alarm_by_its_condition(void)
{
	static const struct {
		int state, activity, mask, polarity, control;
		bool alarm;
	} cases[] = {
		{0xff, 0x00, 0x0f, 0x00, 0x88, true},  /* power-on */
		{0xff, 0x00, 0x00, 0x00, 0x80, false}, /* nothing is selected */
		{0xff, 0x00, 0x0f, 0x00, 0x80, false},
		{0xfb, 0x00, 0x0f, 0x00, 0x80, true},  /* one pin low */
		{0xfb, 0x00, 0x0f, 0x00, 0x82, false}, /* but all are asked for */
		{0xf0, 0x00, 0x0f, 0x00, 0x82, true},
		{0xff, 0x10, 0x30, 0x30, 0x81, true}, /* a latch */
		{0x00, 0x00, 0x30, 0x30, 0x81, false},
	};

	fs_board(0xff, 0x88);
	fs_start();
	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		fs_byte(BOARD, "state", cases[i].state);
		fs_byte(BOARD, "activity", cases[i].activity);
		fs_byte(BOARD, "cond_search_mask", cases[i].mask);
		fs_byte(BOARD, "cond_search_polarity", cases[i].polarity);
		fs_byte(BOARD, "status_control", cases[i].control);
		host_run(&fs.host, fs.bus, fs.host.now + 11 * HOST_S);
		fs_lists(cases[i].alarm ? "/alarm" BOARD_OW "\n" : "", "/alarm/29");
	}
}

static void test_where_nothing_tells_the_alarm_it_is_not_supported(void)
{
	fs_slave("12-0000000000e1");
	fs_text("12-0000000000e1", "state", "1");
	fs_text("12-0000000000e1", "output", "3");
	fs_board(0xff, 0x88);
	fs_start();
	TEST_ASSERT_EQUAL_INT(-EOPNOTSUPP, fs_result(fs_ask(BUS_DIR, "/alarm/29,12", NULL, 0)));
	fs_lists("/alarm" BOARD_OW "\n", "/alarm/29");
	TEST_ASSERT_EQUAL_UINT(0, host_events(&fs.host, BUS_DOWN));
}

static void test_a_slave_that_is_just_being_removed_does_not_end_the_alarm_search(void)
{
	fs_slave(BOARD);
	fs_start();
	fs_lists("", "/alarm/29");
	fs_text(BOARD, "rw", "");
	TEST_ASSERT_EQUAL_INT(-EOPNOTSUPP, fs_result(fs_ask(BUS_DIR, "/alarm/29", NULL, 0)));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_thermometer_beyond_its_limits_is_in_alarm);
	RUN_TEST(test_thermometers_asked_for_their_alarm_convert_at_once);
	RUN_TEST(test_a_ds2408_is_in_alarm_by_its_condition);
	RUN_TEST(test_where_nothing_tells_the_alarm_it_is_not_supported);
	RUN_TEST(test_a_slave_that_is_just_being_removed_does_not_end_the_alarm_search);
	return UNITY_END();
}
