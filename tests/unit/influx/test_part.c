/* SPDX-License-Identifier: MIT */
/* Tests of the parts in which a batch is sent to a server that takes little at once. */
#include <string.h>

#include "unity.h"

#include "src/faces/influx/part.h"

static const char batch[] = "one 1\ntwo 22\nthree 333\nfour 4\n";
#define LEN (sizeof(batch) - 1)

void setUp(void)
{
}

void tearDown(void)
{
}

static void test_a_batch_is_sent_whole_as_long_as_the_server_takes_it(void)
{
	struct part part = {0};

	TEST_ASSERT_EQUAL_size_t(LEN, part_next(&part, batch, LEN));
	part_taken(&part);
	TEST_ASSERT_EQUAL_size_t(0, part_next(&part, batch, LEN));
}

static void test_a_batch_that_is_too_large_goes_in_halves_of_whole_lines(void)
{
	struct part part = {0};
	size_t at = 0;

	part_next(&part, batch, LEN);
	TEST_ASSERT_TRUE(part_halve(&part, batch));
	while (part_next(&part, batch, LEN)) {
		TEST_ASSERT_EQUAL_size_t(at, part.at);
		TEST_ASSERT_EQUAL_CHAR('\n', batch[part.at + part.len - 1]);
		TEST_ASSERT_LESS_OR_EQUAL_size_t(LEN / 2, part.len);
		at += part.len;
		part_taken(&part);
	}
	TEST_ASSERT_EQUAL_size_t(LEN, at);
}

static void test_a_line_alone_cannot_be_halved_and_is_sent_however_long_it_is(void)
{
	struct part part = {.most = 3};

	TEST_ASSERT_EQUAL_size_t(strlen("one 1\n"), part_next(&part, batch, LEN));
	TEST_ASSERT_FALSE(part_halve(&part, batch));
	part_taken(&part);
	TEST_ASSERT_EQUAL_size_t(strlen("two 22\n"), part_next(&part, batch, LEN));
}

static void test_another_batch_begins_with_what_the_server_took_before(void)
{
	struct part part = {0};

	part_next(&part, batch, LEN);
	TEST_ASSERT_TRUE(part_halve(&part, batch));
	part_next(&part, batch, LEN);
	part_taken(&part);
	part_begin(&part);
	TEST_ASSERT_EQUAL_size_t(0, part.at);
	TEST_ASSERT_LESS_OR_EQUAL_size_t(LEN / 2, part_next(&part, batch, LEN));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_batch_is_sent_whole_as_long_as_the_server_takes_it);
	RUN_TEST(test_a_batch_that_is_too_large_goes_in_halves_of_whole_lines);
	RUN_TEST(test_a_line_alone_cannot_be_halved_and_is_sent_however_long_it_is);
	RUN_TEST(test_another_batch_begins_with_what_the_server_took_before);
	return UNITY_END();
}
