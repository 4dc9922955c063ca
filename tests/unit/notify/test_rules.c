/* SPDX-License-Identifier: MIT */
/* Tests of the rules of owsd-notify: severity, choice of signals, quiet hours. */
#include "unity.h"

#include "src/faces/notify/queue.h"

void setUp(void)
{
}

void tearDown(void)
{
}

static void test_the_outer_limits_and_a_device_are_critical(void)
{
	struct ows_alarm alarm = {.event = OWS_ALARM_RAISED};

	for (alarm.kind = OWS_ALARM_DEVICE; alarm.kind <= OWS_ALARM_DIFFERS; alarm.kind++)
		TEST_ASSERT_EQUAL_INT(
			alarm.kind == OWS_ALARM_DEVICE || alarm.kind == OWS_ALARM_POR ||
				alarm.kind == OWS_ALARM_HH || alarm.kind == OWS_ALARM_LL,
			rules_critical(&alarm));
	alarm = (struct ows_alarm){.kind = OWS_ALARM_HH, .event = OWS_ALARM_RAISED};
	TEST_ASSERT_TRUE(rules_urgent(&alarm));
	alarm.kind = OWS_ALARM_H;
	TEST_ASSERT_FALSE(rules_urgent(&alarm));
	/* its return is told to who wants critical ones alone, but wakes nobody */
	alarm = (struct ows_alarm){.kind = OWS_ALARM_HH, .event = OWS_ALARM_RETURNED};
	TEST_ASSERT_FALSE(rules_urgent(&alarm));
	TEST_ASSERT_TRUE(rules_critical(&alarm));
	TEST_ASSERT_FALSE(rules_critical(
		&(struct ows_alarm){.kind = OWS_ALARM_DEVICE, .event = OWS_ALARM_FAILED}));
}

static void test_the_last_pattern_that_fits_decides(void)
{
	TEST_ASSERT_TRUE(rules_chosen("*", "room"));
	TEST_ASSERT_TRUE(rules_chosen("cellar*, freezer", "freezer"));
	TEST_ASSERT_FALSE(rules_chosen("cellar*, freezer", "freezer2"));
	TEST_ASSERT_FALSE(rules_chosen("*, !test*", "test1"));
	TEST_ASSERT_TRUE(rules_chosen("*,!test*,test2", "test2"));
	TEST_ASSERT_TRUE(rules_chosen("!test*", "room"));
	TEST_ASSERT_FALSE(rules_chosen("!test*", "test1"));
	TEST_ASSERT_FALSE(rules_chosen("", "room"));
}

static void test_quiet_hours_go_over_midnight(void)
{
	TEST_ASSERT_FALSE(rules_quiet(NULL, 0));
	TEST_ASSERT_TRUE(rules_quiet("22:00-06:30", 22 * 60));
	TEST_ASSERT_TRUE(rules_quiet("22:00-06:30", 0));
	TEST_ASSERT_TRUE(rules_quiet("22:00-06:30", 6 * 60 + 29));
	TEST_ASSERT_FALSE(rules_quiet("22:00-06:30", 6 * 60 + 30));
	TEST_ASSERT_FALSE(rules_quiet("22:00-06:30", 21 * 60 + 59));
	TEST_ASSERT_TRUE(rules_quiet("12:00-24:00", 23 * 60 + 59));
	TEST_ASSERT_FALSE(rules_quiet("12:00-14:00", 14 * 60));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_the_outer_limits_and_a_device_are_critical);
	RUN_TEST(test_the_last_pattern_that_fits_decides);
	RUN_TEST(test_quiet_hours_go_over_midnight);
	return UNITY_END();
}
