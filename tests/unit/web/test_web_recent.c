/* SPDX-License-Identifier: MIT */
/* Tests of the signals in the order of their last change. */
#include "unity.h"

#include "src/faces/web/recent.h"

static struct recent recent;

void setUp(void)
{
	recent = (struct recent){0};
	TEST_ASSERT_TRUE(recent_make(&recent, 5));
}

void tearDown(void)
{
	recent_free(&recent);
}

/* What a client has to get that knows all up to the cursor, as digits. */
static int after(uint64_t cursor)
{
	int all = 0;

	for (int i = recent_after(&recent, cursor); i >= 0; i = recent.of[i].newer)
		all = all * 10 + i;
	return all;
}

static void test_changes_come_in_their_order_each_signal_once(void)
{
	TEST_ASSERT_EQUAL_INT(-1, recent_after(&recent, 0));
	recent_change(&recent, 1, 1, 1000000);
	recent_change(&recent, 2, 1, 1000000);
	recent_change(&recent, 3, 1, 2000000);
	TEST_ASSERT_EQUAL_INT(123, after(0));
	recent_change(&recent, 2, 2, 3000000);
	TEST_ASSERT_EQUAL_INT(132, after(0));
	recent_change(&recent, 1, 2, 4000000);
	TEST_ASSERT_EQUAL_INT(321, after(0));
	recent_change(&recent, 1, 3, 5000000);
	TEST_ASSERT_EQUAL_INT(321, after(0));
}

static void test_a_cursor_gives_what_changed_after_it(void)
{
	recent_change(&recent, 1, 1, 1000000);
	recent_change(&recent, 2, 1, 1000000);
	TEST_ASSERT_EQUAL_INT(2, after(recent.of[1].cursor));
	TEST_ASSERT_EQUAL_INT(-1, recent_after(&recent, recent.newest));
	recent_change(&recent, 1, 2, 1000000);
	TEST_ASSERT_EQUAL_INT(1, after(recent.of[2].cursor));
}

static void test_cursors_grow_also_when_time_does_not(void)
{
	uint64_t first = recent_next(&recent, 5000000), second = recent_next(&recent, 5000000);

	TEST_ASSERT_EQUAL_UINT64(5000, first);
	TEST_ASSERT_TRUE(second > first);
	TEST_ASSERT_TRUE(recent_next(&recent, 4000000) > second);
	/* another table goes on: cursors of the one before stay older */
	TEST_ASSERT_TRUE(recent_make(&recent, 2));
	TEST_ASSERT_TRUE(recent_next(&recent, 0) > second);
	TEST_ASSERT_EQUAL_INT(-1, recent_after(&recent, 0));
}

static void test_the_same_again_is_no_change_and_no_signal_is_none(void)
{
	recent_change(&recent, 1, 7, 1000000);
	recent_change(&recent, 2, 7, 1000000);
	recent_change(&recent, 1, 7, 2000000);
	recent_change(&recent, -1, 7, 2000000);
	recent_change(&recent, 5, 7, 2000000);
	TEST_ASSERT_EQUAL_INT(12, after(0));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_changes_come_in_their_order_each_signal_once);
	RUN_TEST(test_a_cursor_gives_what_changed_after_it);
	RUN_TEST(test_cursors_grow_also_when_time_does_not);
	RUN_TEST(test_the_same_again_is_no_change_and_no_signal_is_none);
	return UNITY_END();
}
