/* SPDX-License-Identifier: MIT */
/* How often a user may connect. */
#include "unity.h"

#include "hal/base/time.h"
#include "src/memory/control/often.h"

static struct often often;

void setUp(void)
{
	often = (struct often){0};
}

void tearDown(void)
{
}

static unsigned connects(uid_t uid, unsigned times, int64_t now_ns)
{
	unsigned may = 0;

	for (unsigned i = 0; i < times; i++)
		may += !often_is_too(&often, uid, now_ns);
	return may;
}

static void test_a_user_who_connects_without_end_is_held_to_a_rate(void)
{
	int64_t now_ns = 1000 * NS_PER_S;

	TEST_ASSERT_EQUAL_UINT(OFTEN_ROW, connects(1000, 10000, now_ns));
	TEST_ASSERT_EQUAL_UINT(OFTEN_S, connects(1000, 10000, now_ns + NS_PER_S));
	/* after a rest it may do so again, and has saved up no more */
	TEST_ASSERT_EQUAL_UINT(OFTEN_ROW, connects(1000, 10000, now_ns + 3600 * NS_PER_S));
}

static void test_another_user_has_an_account_of_its_own(void)
{
	int64_t now_ns = 1000 * NS_PER_S;

	connects(1000, 10000, now_ns);
	TEST_ASSERT_EQUAL_UINT(OFTEN_ROW, connects(1001, 10000, now_ns));
	TEST_ASSERT_EQUAL_UINT(0, connects(1000, 10, now_ns));
	/* with more users than there are accounts those that connect without end keep theirs */
	for (uid_t uid = 2000; uid < 2000 + 3 * OFTEN_USERS; uid++)
		TEST_ASSERT_EQUAL_UINT(1, connects(uid, 1, now_ns));
	TEST_ASSERT_EQUAL_UINT(0, connects(1000, 10, now_ns));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_user_who_connects_without_end_is_held_to_a_rate);
	RUN_TEST(test_another_user_has_an_account_of_its_own);
	return UNITY_END();
}
