/* SPDX-License-Identifier: MIT */
/* Tests of lines that wait in memory, and of the batches that they become. */
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "src/faces/influx/pending.h"

static struct pending pending;
static char batch[BATCH_BYTES + 1];

void setUp(void)
{
	pending = (struct pending){0};
}

void tearDown(void)
{
	pending_free(&pending);
}

static unsigned lines;

/* A batch of at most so many bytes; the server has it. */
static size_t cut_part(int64_t offset_ns, size_t most)
{
	size_t len = pending_copy(&pending, offset_ns, most, batch, &lines);

	TEST_ASSERT_TRUE(len <= BATCH_BYTES);
	batch[len] = '\0';
	TEST_ASSERT_EQUAL_size_t(len, strlen(batch));
	pending_remove(&pending, pending.first + lines);
	return len;
}

static size_t cut(int64_t offset_ns)
{
	return cut_part(offset_ns, BATCH_BYTES);
}

static void test_a_batch_has_the_time_that_is_known_when_it_is_made(void)
{
	pending_add(&pending, 5, "ows,signal=a", "value=1");
	pending_add(&pending, 7, "ows,signal=b", "quality=8i");
	cut(INT64_C(1700000000000000000));
	TEST_ASSERT_EQUAL_STRING("ows,signal=a value=1 1700000000000000005\n"
	                         "ows,signal=b quality=8i 1700000000000000007\n",
	                         batch);
	TEST_ASSERT_EQUAL_size_t(0, cut(0));
	TEST_ASSERT_EQUAL_UINT(0, pending.lines);
}

static void test_a_line_of_a_wall_clock_time_keeps_it(void)
{
	pending_add(&pending, 5, "s", "value=1");
	pending_add_dated(&pending, INT64_C(1600000000000000000), "s", "value=2");
	pending_copy(&pending, 1000, BATCH_BYTES, batch, &lines);
	cut(INT64_C(1700000000000000000));
	TEST_ASSERT_EQUAL_STRING("s value=1 1700000000000000005\n"
	                         "s value=2 1600000000000000000\n",
	                         batch);
}

static void test_a_dropped_line_of_a_wall_clock_time_has_no_boot_time(void)
{
	static char fields[1000];

	memset(fields, 'x', sizeof(fields) - 1);
	for (int64_t i = 0; !pending.dropped; i++)
		pending_add_dated(&pending, INT64_C(1600000000000000000) + i, "s", fields);
	TEST_ASSERT_EQUAL_INT64(0, pending.dropped_ns);
}

static void test_lines_stay_until_they_are_removed_by_their_numbers(void)
{
	uint64_t end;

	for (int i = 0; i < 3; i++)
		pending_add(&pending, i, "s", "value=1");
	pending_copy(&pending, 5, BATCH_BYTES, batch, &lines);
	TEST_ASSERT_EQUAL_UINT(3, lines);
	TEST_ASSERT_EQUAL_UINT(3, pending.lines);
	end = pending.first + 2;
	pending_add(&pending, 3, "s", "value=2");
	pending_remove(&pending, end);
	pending_remove(&pending, end); /* those that are gone do not count */
	cut(5);
	TEST_ASSERT_EQUAL_STRING("s value=1 7\ns value=2 8\n", batch);
	TEST_ASSERT_EQUAL_size_t(0, cut(5));
	TEST_ASSERT_EQUAL_UINT(0, lines);
	pending_add(&pending, 3, "s", "value=2");
	end = pending.first + 1;
	pending_free(&pending);
	TEST_ASSERT_EQUAL_UINT64(end, pending.first);
}

static void test_a_server_that_takes_less_gets_whole_lines_and_one_at_least(void)
{
	for (int i = 1; i < 4; i++)
		pending_add(&pending, i, "s", "value=1");
	cut_part(0, 50);
	TEST_ASSERT_EQUAL_STRING("s value=1 1\ns value=1 2\n", batch);
	cut_part(0, 1);
	TEST_ASSERT_EQUAL_STRING("s value=1 3\n", batch);
}

static void test_a_batch_has_at_most_5000_lines_and_the_rest_comes_next(void)
{
	for (int i = 0; i < 5001; i++)
		pending_add(&pending, i, "s", "value=1");
	TEST_ASSERT_TRUE(pending_is_full(&pending));
	cut(0);
	TEST_ASSERT_EQUAL_UINT(BATCH_LINES, lines);
	TEST_ASSERT_FALSE(pending_is_full(&pending));
	cut(0);
	TEST_ASSERT_EQUAL_STRING("s value=1 5000\n", batch);
}

static void test_a_batch_has_at_most_a_megabyte(void)
{
	char fields[2000], last[16];
	unsigned all = 0, batches = 0;

	memset(fields, 'x', sizeof(fields) - 1);
	fields[sizeof(fields) - 1] = '\0';
	for (int i = 0; i < 1200; i++)
		pending_add(&pending, i, "s", fields);
	for (size_t len; (len = cut(0)) > 0; batches++) {
		all += lines;
		snprintf(last, sizeof(last), " %u\n", all - 1);
		TEST_ASSERT_EQUAL_STRING(last, batch + len - strlen(last));
	}
	TEST_ASSERT_EQUAL_UINT(1200, all);
	TEST_ASSERT_EQUAL_UINT(3, batches);
}

static void test_the_oldest_go_when_memory_is_full_and_they_are_counted(void)
{
	char fields[1000], first[16];
	size_t len;

	memset(fields, 'x', sizeof(fields) - 1);
	fields[sizeof(fields) - 1] = '\0';
	for (int i = 0; i < 10000; i++)
		pending_add(&pending, i, "s", fields);
	TEST_ASSERT_TRUE(pending.room <= PENDING_BYTES && pending.len <= pending.room);
	TEST_ASSERT_EQUAL_UINT64(10000, pending.dropped + pending.lines);
	TEST_ASSERT_TRUE(pending.lines > 2000);
	TEST_ASSERT_EQUAL_UINT64(pending.dropped, pending.first);
	TEST_ASSERT_EQUAL_INT64(pending.dropped - 1, pending.dropped_ns);
	len = cut(0);
	snprintf(first, sizeof(first), " %u\n", (unsigned)pending.dropped);
	TEST_ASSERT_TRUE(len > 0);
	TEST_ASSERT_EQUAL_STRING_LEN(first, strchr(batch + 2, ' '), strlen(first));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_batch_has_the_time_that_is_known_when_it_is_made);
	RUN_TEST(test_a_line_of_a_wall_clock_time_keeps_it);
	RUN_TEST(test_a_dropped_line_of_a_wall_clock_time_has_no_boot_time);
	RUN_TEST(test_lines_stay_until_they_are_removed_by_their_numbers);
	RUN_TEST(test_a_server_that_takes_less_gets_whole_lines_and_one_at_least);
	RUN_TEST(test_a_batch_has_at_most_5000_lines_and_the_rest_comes_next);
	RUN_TEST(test_a_batch_has_at_most_a_megabyte);
	RUN_TEST(test_the_oldest_go_when_memory_is_full_and_they_are_counted);
	return UNITY_END();
}
