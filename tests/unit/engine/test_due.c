/* SPDX-License-Identifier: MIT */
/* Tests of the set of due rows and of the schedule. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "unity.h"

#include "src/daemon/engine/due.h"

void setUp(void)
{
}
void tearDown(void)
{
}

static void test_an_empty_set_has_no_next_row(void)
{
	struct due_set set;

	TEST_ASSERT_EQUAL_INT(0, due_set_init(&set, 100));
	TEST_ASSERT_EQUAL_INT64(-1, due_set_next(&set));
	due_set_free(&set);
}

static void test_a_set_of_no_rows_can_be_made_and_asked(void)
{
	struct due_set set;

	TEST_ASSERT_EQUAL_INT(0, due_set_init(&set, 0));
	TEST_ASSERT_EQUAL_INT64(-1, due_set_next(&set));
	due_set_free(&set);
}

static void test_the_cursor_goes_on_where_it_stopped_and_wraps(void)
{
	struct due_set set;

	due_set_init(&set, 3000);
	due_set_add(&set, 5);
	due_set_add(&set, 2900);
	due_set_add(&set, 64);
	TEST_ASSERT_EQUAL_INT64(5, due_set_next(&set));
	due_set_take(&set, 5);
	due_set_add(&set, 5);
	TEST_ASSERT_EQUAL_INT64(64, due_set_next(&set));
	due_set_take(&set, 64);
	TEST_ASSERT_EQUAL_INT64(2900, due_set_next(&set));
	due_set_take(&set, 2900);
	TEST_ASSERT_EQUAL_INT64(5, due_set_next(&set));
	due_set_free(&set);
}

static void test_the_set_agrees_with_a_plain_array(void)
{
	enum { ROWS = 2500 };
	unsigned seed = 20261;
	static bool plain[ROWS];
	struct due_set set;
	uint32_t cursor = 0;

	printf("seed %u\n", seed);
	srand(seed);
	memset(plain, 0, sizeof(plain));
	due_set_init(&set, ROWS);
	for (int round = 0; round < 20000; round++) {
		uint32_t row = (uint32_t)rand() % ROWS;
		int64_t expected = -1;

		if (rand() % 3 == 0) {
			plain[row] = false;
			due_set_remove(&set, row);
		} else if (rand() % 2) {
			plain[row] = true;
			due_set_add(&set, row);
		}
		for (uint32_t i = 0; i < ROWS && expected < 0; i++)
			if (plain[(cursor + i) % ROWS])
				expected = (cursor + i) % ROWS;
		TEST_ASSERT_EQUAL_INT64(expected, due_set_next(&set));
		if (expected >= 0 && rand() % 2) {
			plain[expected] = false;
			due_set_take(&set, (uint32_t)expected);
			cursor = (uint32_t)(expected + 1) % ROWS;
		}
	}
	due_set_free(&set);
}

struct seen {
	uint32_t rows[64];
	unsigned count;
};
static void see(void *ctx, uint32_t row)
{
	struct seen *seen = ctx;

	if (seen->count < 64)
		seen->rows[seen->count++] = row;
}

static void test_a_row_comes_in_its_period_and_not_before(void)
{
	struct due_wheel wheel;
	struct seen seen = {.count = 0};

	due_wheel_init(&wheel, 10, 0);
	due_wheel_at(&wheel, 3, 5);
	due_wheel_advance(&wheel, 4, see, &seen);
	TEST_ASSERT_EQUAL_UINT(0, seen.count);
	due_wheel_advance(&wheel, 5, see, &seen);
	TEST_ASSERT_EQUAL_UINT(1, seen.count);
	TEST_ASSERT_EQUAL_UINT32(3, seen.rows[0]);
	due_wheel_advance(&wheel, 5000, see, &seen);
	TEST_ASSERT_EQUAL_UINT(1, seen.count);
	due_wheel_free(&wheel);
}

static void test_a_wait_longer_than_the_wheel_goes_round_more_than_once(void)
{
	struct due_wheel wheel;
	struct seen seen = {.count = 0};

	due_wheel_init(&wheel, 2, 0);
	due_wheel_at(&wheel, 1, 3 * DUE_BUCKETS + 7);
	for (uint64_t p = 1; p < 3 * DUE_BUCKETS + 7; p++)
		due_wheel_advance(&wheel, p, see, &seen);
	TEST_ASSERT_EQUAL_UINT(0, seen.count);
	due_wheel_advance(&wheel, 3 * DUE_BUCKETS + 7, see, &seen);
	TEST_ASSERT_EQUAL_UINT(1, seen.count);
	due_wheel_free(&wheel);
}

static void test_a_turn_over_many_periods_misses_nobody(void)
{
	struct due_wheel wheel;
	struct seen seen = {.count = 0};

	due_wheel_init(&wheel, 40, 0);
	for (uint32_t row = 0; row < 40; row++)
		due_wheel_at(&wheel, row, 1 + row * 97);
	due_wheel_advance(&wheel, 10 * DUE_BUCKETS, see, &seen);
	TEST_ASSERT_EQUAL_UINT(40, seen.count);
	due_wheel_free(&wheel);
}

static void test_a_new_wait_replaces_the_old_one_and_a_cancelled_one_is_gone(void)
{
	struct due_wheel wheel;
	struct seen seen = {.count = 0};

	due_wheel_init(&wheel, 4, 0);
	due_wheel_at(&wheel, 0, 2);
	due_wheel_at(&wheel, 0, 9);
	due_wheel_at(&wheel, 1, 9);
	due_wheel_at(&wheel, 2, 9);
	due_wheel_cancel(&wheel, 1);
	due_wheel_advance(&wheel, 8, see, &seen);
	TEST_ASSERT_EQUAL_UINT(0, seen.count);
	due_wheel_advance(&wheel, 9, see, &seen);
	TEST_ASSERT_EQUAL_UINT(2, seen.count);
	due_wheel_free(&wheel);
}

static void test_a_wait_for_the_past_comes_with_the_next_period(void)
{
	struct due_wheel wheel;
	struct seen seen = {.count = 0};

	due_wheel_init(&wheel, 1, 100);
	due_wheel_at(&wheel, 0, 3);
	due_wheel_advance(&wheel, 101, see, &seen);
	TEST_ASSERT_EQUAL_UINT(1, seen.count);
	due_wheel_free(&wheel);
}

/* The present period is over for the wheel: what waits for it is not to wait for a whole turn. */
static void test_a_wait_for_the_present_period_comes_with_the_next_one(void)
{
	struct due_wheel wheel;
	struct seen seen = {.count = 0};

	due_wheel_init(&wheel, 2, 100);
	due_wheel_at(&wheel, 0, 100);
	due_wheel_at(&wheel, 1, 101);
	TEST_ASSERT_EQUAL_UINT64(101, due_wheel_next(&wheel, 100, 200));
	due_wheel_advance(&wheel, 101, see, &seen);
	TEST_ASSERT_EQUAL_UINT(2, seen.count);
	due_wheel_free(&wheel);
}

/* A turn that ends where it began has no period, and one to the last bucket has them all. */
static void test_a_turn_to_the_present_period_or_back_gives_nobody(void)
{
	struct due_wheel wheel;
	struct seen seen = {.count = 0};

	due_wheel_init(&wheel, 2, 100);
	due_wheel_at(&wheel, 0, 101);
	due_wheel_at(&wheel, 1, 100 + DUE_BUCKETS);
	due_wheel_advance(&wheel, 100, see, &seen);
	due_wheel_advance(&wheel, 40, see, &seen);
	TEST_ASSERT_EQUAL_UINT(0, seen.count);
	due_wheel_advance(&wheel, 99 + DUE_BUCKETS, see, &seen);
	TEST_ASSERT_EQUAL_UINT(1, seen.count);
	due_wheel_advance(&wheel, 100 + DUE_BUCKETS, see, &seen);
	TEST_ASSERT_EQUAL_UINT(2, seen.count);
	due_wheel_free(&wheel);
}

/* It may be too soon, by a row of a later round, and never too late. */
static void test_the_next_period_for_which_a_row_waits_is_found(void)
{
	struct due_wheel wheel;
	struct seen seen = {.count = 0};

	due_wheel_init(&wheel, 10, 1000);
	TEST_ASSERT_EQUAL_UINT64(1500, due_wheel_next(&wheel, 1000, 1500));
	for (uint64_t p = 1001; p < 1500; p++) {
		due_wheel_at(&wheel, 3, p);
		TEST_ASSERT_EQUAL_UINT64(p, due_wheel_next(&wheel, 1000, 1500));
	}
	due_wheel_at(&wheel, 4, 1031);
	due_wheel_at(&wheel, 5, 1031);
	TEST_ASSERT_EQUAL_UINT64(1031, due_wheel_next(&wheel, 1000, 1500));
	TEST_ASSERT_EQUAL_UINT64(1030, due_wheel_next(&wheel, 1000, 1030));
	due_wheel_cancel(&wheel, 4);
	TEST_ASSERT_EQUAL_UINT64(1031, due_wheel_next(&wheel, 1000, 1500));
	due_wheel_advance(&wheel, 1031, see, &seen);
	TEST_ASSERT_EQUAL_UINT(1, seen.count);
	TEST_ASSERT_EQUAL_UINT64(1499, due_wheel_next(&wheel, 1031, 1500));
	due_wheel_at(&wheel, 6, 1040 + 2 * DUE_BUCKETS);
	TEST_ASSERT_EQUAL_UINT64(1040, due_wheel_next(&wheel, 1031, 1500));
	due_wheel_free(&wheel);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_an_empty_set_has_no_next_row);
	RUN_TEST(test_a_set_of_no_rows_can_be_made_and_asked);
	RUN_TEST(test_the_cursor_goes_on_where_it_stopped_and_wraps);
	RUN_TEST(test_the_set_agrees_with_a_plain_array);
	RUN_TEST(test_a_row_comes_in_its_period_and_not_before);
	RUN_TEST(test_a_wait_longer_than_the_wheel_goes_round_more_than_once);
	RUN_TEST(test_a_turn_over_many_periods_misses_nobody);
	RUN_TEST(test_a_new_wait_replaces_the_old_one_and_a_cancelled_one_is_gone);
	RUN_TEST(test_a_wait_for_the_past_comes_with_the_next_period);
	RUN_TEST(test_a_wait_for_the_present_period_comes_with_the_next_one);
	RUN_TEST(test_a_turn_to_the_present_period_or_back_gives_nobody);
	RUN_TEST(test_the_next_period_for_which_a_row_waits_is_found);
	return UNITY_END();
}
