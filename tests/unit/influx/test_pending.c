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

static size_t cut(int64_t offset_ns)
{
	size_t len = pending_cut(&pending, offset_ns, batch);

	TEST_ASSERT_TRUE(len <= BATCH_BYTES);
	batch[len] = '\0';
	TEST_ASSERT_EQUAL_size_t(len, strlen(batch));
	return len;
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

static void test_a_copy_leaves_the_lines_until_they_are_removed(void)
{
	unsigned lines;
	size_t len;

	for (int i = 0; i < 3; i++)
		pending_add(&pending, i, "s", "value=1");
	len = pending_copy(&pending, 5, batch, &lines);
	TEST_ASSERT_EQUAL_UINT(3, lines);
	TEST_ASSERT_EQUAL_UINT(3, batch_lines(batch, len));
	TEST_ASSERT_EQUAL_UINT(3, pending.lines);
	pending_add(&pending, 3, "s", "value=2");
	pending_remove(&pending, 2);
	cut(5);
	TEST_ASSERT_EQUAL_STRING("s value=1 7\ns value=2 8\n", batch);
	len = pending_copy(&pending, 5, batch, &lines);
	TEST_ASSERT_EQUAL_UINT(0, lines);
	TEST_ASSERT_EQUAL_size_t(0, len);
}

static void test_a_batch_has_at_most_5000_lines_and_the_rest_comes_next(void)
{
	for (int i = 0; i < 5001; i++)
		pending_add(&pending, i, "s", "value=1");
	TEST_ASSERT_TRUE(pending_is_full(&pending));
	TEST_ASSERT_EQUAL_UINT(BATCH_LINES, batch_lines(batch, cut(0)));
	TEST_ASSERT_FALSE(pending_is_full(&pending));
	cut(0);
	TEST_ASSERT_EQUAL_STRING("s value=1 5000\n", batch);
}

static void test_a_batch_has_at_most_a_megabyte(void)
{
	char fields[2000], last[16];
	unsigned lines = 0, batches = 0;

	memset(fields, 'x', sizeof(fields) - 1);
	fields[sizeof(fields) - 1] = '\0';
	for (int i = 0; i < 1200; i++)
		pending_add(&pending, i, "s", fields);
	for (size_t len; (len = cut(0)) > 0; batches++) {
		lines += batch_lines(batch, len);
		snprintf(last, sizeof(last), " %u\n", lines - 1);
		TEST_ASSERT_EQUAL_STRING(last, batch + len - strlen(last));
	}
	TEST_ASSERT_EQUAL_UINT(1200, lines);
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
	len = cut(0);
	snprintf(first, sizeof(first), " %u\n", (unsigned)pending.dropped);
	TEST_ASSERT_TRUE(len > 0);
	TEST_ASSERT_EQUAL_STRING_LEN(first, strchr(batch + 2, ' '), strlen(first));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_batch_has_the_time_that_is_known_when_it_is_made);
	RUN_TEST(test_a_copy_leaves_the_lines_until_they_are_removed);
	RUN_TEST(test_a_batch_has_at_most_5000_lines_and_the_rest_comes_next);
	RUN_TEST(test_a_batch_has_at_most_a_megabyte);
	RUN_TEST(test_the_oldest_go_when_memory_is_full_and_they_are_counted);
	return UNITY_END();
}
