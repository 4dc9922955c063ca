/* SPDX-License-Identifier: MIT */
/* Tests of the room that bodies have. */
#include <stdlib.h>
#include <string.h>

#include "unity.h"

#include "hal/base/time.h"
#include "src/faces/web/head.h"
#include "src/faces/web/jobs.h"

#define LARGE (BODY_MAX + 1)

static unsigned large;
static struct posted posted[4];

void setUp(void)
{
	large = 0;
}

void tearDown(void)
{
	for (size_t i = 0; i < 4; i++)
		posted_free(&posted[i]);
	TEST_ASSERT_EQUAL_UINT(0, large);
}

static void test_a_body_is_kept_as_it_comes_and_no_longer_than_announced(void)
{
	posted_begin(&posted[0], 4, &large, false, 0);
	TEST_ASSERT_TRUE(posted_add(&posted[0], "ab", 2, NS_PER_S));
	TEST_ASSERT_TRUE(posted_add(&posted[0], "cd", 2, POSTED_S * NS_PER_S));
	TEST_ASSERT_EQUAL_MEMORY("abcd", posted[0].bytes, 4);
	TEST_ASSERT_FALSE(posted_add(&posted[0], "e", 1, 0));
	TEST_ASSERT_EQUAL_UINT(0, large);
}

/* The time limit of its connection begins anew with each byte. */
static void test_a_small_one_that_comes_byte_by_byte_ends_too(void)
{
	posted_begin(&posted[0], 4, &large, false, 5);
	TEST_ASSERT_TRUE(posted_add(&posted[0], "a", 1, 5 + POSTED_S * NS_PER_S));
	TEST_ASSERT_FALSE(posted_add(&posted[0], "b", 1, 6 + POSTED_S * NS_PER_S));
}

static void test_two_large_ones_have_room_and_give_it_back(void)
{
	for (size_t i = 0; i < 3; i++)
		posted_begin(&posted[i], LARGE, &large, true, 0);
	TEST_ASSERT_EQUAL_UINT(POSTED_LARGE, large);
	TEST_ASSERT_FALSE(posted[1].dropped);
	TEST_ASSERT_TRUE(posted[2].dropped);
	TEST_ASSERT_TRUE(posted_add(&posted[2], "x", 1, 0));
	TEST_ASSERT_NULL(posted[2].bytes);
	TEST_ASSERT_TRUE(posted_add(&posted[1], "x", 1, 0));
	posted_free(&posted[1]);
	posted_begin(&posted[3], LARGE, &large, true, 0);
	TEST_ASSERT_FALSE(posted[3].dropped);
}

static void test_a_large_one_of_somebody_without_the_right_is_not_kept(void)
{
	posted_begin(&posted[0], LARGE, &large, false, 0);
	TEST_ASSERT_EQUAL_UINT(0, large);
	TEST_ASSERT_TRUE(posted_add(&posted[0], "x", 1, 0));
	TEST_ASSERT_NULL(posted[0].bytes);
}

static void test_a_large_one_that_drips_in_is_given_up(void)
{
	posted_begin(&posted[0], LARGE, &large, true, 5 * NS_PER_S);
	TEST_ASSERT_TRUE(posted_add(&posted[0], "x", 1, (5 + POSTED_S) * NS_PER_S));
	TEST_ASSERT_FALSE(posted_add(&posted[0], "x", 1, (5 + POSTED_S) * NS_PER_S + 1));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_body_is_kept_as_it_comes_and_no_longer_than_announced);
	RUN_TEST(test_a_small_one_that_comes_byte_by_byte_ends_too);
	RUN_TEST(test_two_large_ones_have_room_and_give_it_back);
	RUN_TEST(test_a_large_one_of_somebody_without_the_right_is_not_kept);
	RUN_TEST(test_a_large_one_that_drips_in_is_given_up);
	return UNITY_END();
}
