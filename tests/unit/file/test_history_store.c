/* SPDX-License-Identifier: MIT */
/* Commits by hand: what is in the file after each, and what a file that goes away costs. */
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "unity.h"

#include "src/history/file/store.h"
#include "tests/unit/aid/past.h"

#define SECOND_US INT64_C(1000000)

static struct past past;
static struct history_store store;
static struct history_key key;

static void say(void *ctx, const char *text)
{
	(void)ctx;
	(void)text;
}

void setUp(void)
{
	past_make(&past);
	key = (struct history_key){.name = "room", .unit = "V", .type = OWS_LONG};
	store = (struct history_store){
		.file = {.directory = past.directory, .say = say}, .keep = {.days = 0}, .boot = 1};
	store_begin(&store);
}

void tearDown(void)
{
	store_close(&store);
}

static int commit(const struct history_row *rows, uint32_t count, int64_t seen_s)
{
	struct store_batch batch = {.keys = &key,
	                            .key_count = 1,
	                            .rows = rows,
	                            .count = count,
	                            .begin_us = SECOND_US,
	                            .seen_us = seen_s * SECOND_US,
	                            .offset_us = PAST_NOON / 1000,
	                            .trusted = true};

	return store_commit(&store, &batch);
}

static struct history_row value_at(int64_t s, int64_t value)
{
	return (struct history_row){.us = s * SECOND_US,
	                            .value = value,
	                            .kind = ROW_VALUE,
	                            .type = OWS_LONG,
	                            .quality = OWS_Q_GOOD};
}

static void test_a_commit_is_whole_in_the_file_and_counted(void)
{
	const struct history_row rows[] = {value_at(2, 20), value_at(3, 21)};

	TEST_ASSERT_EQUAL_INT(0, store_ready(&store));
	TEST_ASSERT_EQUAL_INT(0, commit(rows, 2, 4));
	TEST_ASSERT_EQUAL_UINT64(1, store.commits);
	TEST_ASSERT_EQUAL_UINT64(2, store.rows);
	TEST_ASSERT_NOT_EQUAL_UINT32(0, key.number);
	store_close(&store);
	TEST_ASSERT_EQUAL_INT64(2, past_ask(&past, "select count(*) from raw"));
	TEST_ASSERT_EQUAL_INT64(1, past_ask(&past, "select count(*) from signal"));
}

/* Without a row: when the sums of an hour can be written. */
static void test_without_rows_it_is_due_when_an_hour_is_over(void)
{
	const struct history_row row = value_at(2, 20);

	TEST_ASSERT_EQUAL_INT(0, store_ready(&store));
	TEST_ASSERT_EQUAL_INT(0, commit(&row, 1, 4));
	for (int64_t s = 590; s < 3600; s += 590)
		TEST_ASSERT_EQUAL_INT(0, commit(NULL, 0, s));
	TEST_ASSERT_FALSE(store_is_due(&store, 3599 * SECOND_US));
	TEST_ASSERT_TRUE(store_is_due(&store, 3601 * SECOND_US));
	TEST_ASSERT_EQUAL_INT(0, commit(NULL, 0, 3601));
	TEST_ASSERT_FALSE(store_is_due(&store, 3602 * SECOND_US));
	store_close(&store);
	TEST_ASSERT_EQUAL_INT64(1, past_ask(&past, "select count(*) from minute"));
	TEST_ASSERT_EQUAL_INT64(1, past_ask(&past, "select count(*) from hour"));
}

static void test_a_file_that_was_removed_is_made_again_and_nothing_is_written_beside_it(void)
{
	const struct history_row first = value_at(2, 20), second = value_at(5, 21);
	char path[400];

	TEST_ASSERT_EQUAL_INT(0, store_ready(&store));
	TEST_ASSERT_EQUAL_INT(0, commit(&first, 1, 4));
	snprintf(path, sizeof(path), "%s/history.sqlite", past.directory);
	TEST_ASSERT_EQUAL_INT(0, unlink(path));
	TEST_ASSERT_FALSE(file_is_there(&store.file));
	TEST_ASSERT_EQUAL_INT(-ENOENT, store_ready(&store));
	TEST_ASSERT_EQUAL_INT(0, store_ready(&store));
	TEST_ASSERT_TRUE(file_is_there(&store.file));
	TEST_ASSERT_EQUAL_INT(0, commit(&second, 1, 6));
	store_close(&store);
	TEST_ASSERT_EQUAL_INT64(1, past_ask(&past, "select count(*) from raw"));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_commit_is_whole_in_the_file_and_counted);
	RUN_TEST(test_without_rows_it_is_due_when_an_hour_is_over);
	RUN_TEST(test_a_file_that_was_removed_is_made_again_and_nothing_is_written_beside_it);
	return UNITY_END();
}
