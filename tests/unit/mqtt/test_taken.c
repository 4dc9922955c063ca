/* SPDX-License-Identifier: MIT */
/* Tests of whether another client takes our id. */
#include "unity.h"

#include "src/faces/mqtt/taken.h"

static struct taken taken;

void setUp(void)
{
	taken = (struct taken){0};
}

void tearDown(void)
{
}

static void test_what_the_broker_says_counts_however_long_it_lasted(void)
{
	TEST_ASSERT_FALSE(taken_again(&taken));
	TEST_ASSERT_TRUE(taken_end(&taken, TAKEN_TOLD, 3600 * NS_PER_S));
	TEST_ASSERT_TRUE(taken_again(&taken));
	TEST_ASSERT_TRUE(taken_end(&taken, TAKEN_TOLD, 0));
}

static void test_a_plain_loss_after_it_is_none(void)
{
	taken_end(&taken, TAKEN_TOLD, NS_PER_S);
	TEST_ASSERT_FALSE(taken_end(&taken, TAKEN_CLOSED, 20 * NS_PER_S));
	TEST_ASSERT_FALSE(taken_again(&taken));
	taken_end(&taken, TAKEN_TOLD, NS_PER_S);
	TEST_ASSERT_FALSE(taken_end(&taken, TAKEN_CLOSED, NS_PER_S));
	TEST_ASSERT_TRUE(taken_again(&taken)); /* of the next connection nobody knows */
	TEST_ASSERT_TRUE(taken_end(&taken, TAKEN_CLOSED, NS_PER_S));
}

static void test_nor_is_one_after_a_loss_that_is_explained_later(void)
{
	TEST_ASSERT_FALSE(taken_end(&taken, TAKEN_CLOSED, NS_PER_S));
	taken_proved(&taken);
	TEST_ASSERT_FALSE(taken_end(&taken, TAKEN_CLOSED, NS_PER_S));
	TEST_ASSERT_TRUE(taken_end(&taken, TAKEN_CLOSED, NS_PER_S));
}

static void test_an_attempt_in_vain_shows_that_the_broker_is_away(void)
{
	taken_end(&taken, TAKEN_TOLD, NS_PER_S);
	TEST_ASSERT_FALSE(taken_end(&taken, TAKEN_OTHER, 0));
	TEST_ASSERT_FALSE(taken_again(&taken));
	taken_end(&taken, TAKEN_CLOSED, NS_PER_S);
	taken_end(&taken, TAKEN_CLOSED, NS_PER_S);
	taken_end(&taken, TAKEN_OTHER, 0);
	TEST_ASSERT_FALSE(taken_end(&taken, TAKEN_CLOSED, NS_PER_S));
}

static void test_brief_connections_in_a_row_look_like_it(void)
{
	for (int i = 1; i < TAKEN_BRIEF_MOST; i++)
		TEST_ASSERT_FALSE(taken_end(&taken, TAKEN_CLOSED, TAKEN_BRIEF_NS));
	TEST_ASSERT_FALSE(taken_again(&taken));
	TEST_ASSERT_TRUE(taken_end(&taken, TAKEN_CLOSED, TAKEN_BRIEF_NS));
	TEST_ASSERT_TRUE(taken_end(&taken, TAKEN_CLOSED, 0));
	TEST_ASSERT_TRUE(taken_again(&taken));
	TEST_ASSERT_FALSE(taken.contested); /* looks like it, and is not proved */
	TEST_ASSERT_FALSE(taken_end(&taken, TAKEN_CLOSED, TAKEN_BRIEF_NS + 1));
	TEST_ASSERT_FALSE(taken_end(&taken, TAKEN_CLOSED, 0));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_what_the_broker_says_counts_however_long_it_lasted);
	RUN_TEST(test_a_plain_loss_after_it_is_none);
	RUN_TEST(test_nor_is_one_after_a_loss_that_is_explained_later);
	RUN_TEST(test_an_attempt_in_vain_shows_that_the_broker_is_away);
	RUN_TEST(test_brief_connections_in_a_row_look_like_it);
	return UNITY_END();
}
