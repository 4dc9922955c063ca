/* SPDX-License-Identifier: MIT */
/* Tests of the move of what owsd-notify knows into the signals of another image. */
#include <stdlib.h>

#include "unity.h"

#include "src/faces/notify/rows.h"
#include "tests/unit/aid/instance.h"

static struct queue queue;

void setUp(void)
{
	queue = (struct queue){0};
}

void tearDown(void)
{
}

static void test_what_is_known_follows_the_identity_and_so_does_what_waits(void)
{
	struct row before[] = {{.print = 30, .bad_ns = 3, .told = true, .chosen = true},
	                       {.print = 10, .raised_ns = 1, .chosen = true},
	                       {.print = 20, .raised_ns = 2, .chosen = true},
	                       {.print = 40, .raised_ns = 4, .chosen = true}};
	struct row after[] = {{.print = 10, .chosen = true},
	                      {.print = 50, .chosen = true},
	                      {.print = 30, .chosen = true},
	                      {.print = 20}};
	struct rows from = {before, 4}, to = {after, 4};

	for (int i = 0; i < 4; i++)
		*queue_add(&queue) = (struct entry){.signal = i, .print = before[i].print};
	*queue_add(&queue) = (struct entry){.signal = -1};
	rows_carry(&from, &to, &queue);
	TEST_ASSERT_EQUAL_INT64(1, after[0].raised_ns);
	TEST_ASSERT_EQUAL_INT64(0, after[1].raised_ns);
	TEST_ASSERT_EQUAL_INT64(3, after[2].bad_ns);
	TEST_ASSERT_TRUE(after[2].told);
	TEST_ASSERT_EQUAL_INT64(0, after[3].raised_ns); /* it is not chosen */
	TEST_ASSERT_EQUAL_INT(2, queue_at(&queue, 0)->signal);
	TEST_ASSERT_EQUAL_INT(0, queue_at(&queue, 1)->signal);
	TEST_ASSERT_EQUAL_INT(3, queue_at(&queue, 2)->signal);
	TEST_ASSERT_EQUAL_INT(-1, queue_at(&queue, 3)->signal); /* it is gone */
	TEST_ASSERT_EQUAL_INT(-1, queue_at(&queue, 4)->signal);
}

static void test_nothing_is_carried_from_nothing(void)
{
	struct row after = {.print = 10, .chosen = true};
	struct rows from = {NULL, 0}, to = {&after, 1};

	rows_carry(&from, &to, &queue);
	TEST_ASSERT_EQUAL_INT64(0, after.raised_ns);
	rows_carry(&to, &from, &queue);
}

static void test_the_signals_of_an_image_are_chosen_by_name_and_found_again(void)
{
	static const struct instance_signal first[] = {
		{.name = "a", .path = "/28.000000000001/temperature", .type = OWS_DOUBLE},
		{.name = "b", .path = "/28.000000000002/temperature", .type = OWS_DOUBLE},
	};
	static const struct instance_signal second[] = {
		{.name = "c", .path = "/28.000000000002/temperature", .type = OWS_DOUBLE},
		{.name = "x", .path = "/28.000000000003/temperature", .type = OWS_DOUBLE},
	};
	static struct instance in;
	struct config_notify notify = {.given = true, .signals = "*, !x"};
	struct rows rows = {0};
	struct ows *ows;

	instance_start(&in, "rows", first, 2);
	TEST_ASSERT_EQUAL_INT(0, ows_open(in.name, OWS_READ, &ows));
	TEST_ASSERT_TRUE(rows_make(&rows, ows, &notify, &queue));
	TEST_ASSERT_EQUAL_INT(2, rows.count);
	rows.row[1].bad_ns = 7;
	instance_reload(&in, second, 2);
	TEST_ASSERT_EQUAL_INT(0, ows_reopen(ows));
	TEST_ASSERT_TRUE(rows_make(&rows, ows, &notify, &queue));
	TEST_ASSERT_EQUAL_INT64(7, rows.row[0].bad_ns);
	TEST_ASSERT_TRUE(rows.row[0].chosen);
	TEST_ASSERT_FALSE(rows.row[1].chosen);
	ows_close(ows);
	instance_end(&in);
	free(rows.row);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_what_is_known_follows_the_identity_and_so_does_what_waits);
	RUN_TEST(test_nothing_is_carried_from_nothing);
	RUN_TEST(test_the_signals_of_an_image_are_chosen_by_name_and_found_again);
	return UNITY_END();
}
