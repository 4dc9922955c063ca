/* SPDX-License-Identifier: MIT */
/*
 * Power cuts in any write of a recorder: what was synced is there, of all else each sector by
 * chance. What is read of it begins as what was recorded, has at least all that was committed, and
 * nothing else. POWER_CUTS=500 for more of them.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "unity.h"

#include "tests/unit/aid/past.h"
#include "tests/unit/aid/power_file.h"

#define STEP (PAST_S / 4)
#define VALUES 16000

static struct past past;
static struct {
	size_t step; /* when it was over */
	int values;  /* that are in it, and before */
} commits[VALUES];
static int commit_count;

void setUp(void)
{
}

void tearDown(void)
{
}

/* What the room has at step n; each step has a value. */
static double value_of(int64_t n)
{
	return (double)(n * 7919 % 4096) / 16;
}

/* How many values the file has, by what the writer says. */
static int written(void)
{
	struct history_state state;

	history_writer_state(past.writer, &state);
	return (int)(state.rows / 2);
}

static void record(void)
{
	static char text[300];

	past_make(&past);
	past.options.flush_ns = 15 * PAST_S;
	power_file_begin();
	past_begin(&past, 0, PAST_NOON, true);
	for (int64_t n = 1; n <= VALUES; n++) {
		past_room(&past, n * STEP, value_of(n));
		memset(text, 'a' + (int)(n % 26), n % 290);
		text[n % 290] = '\0';
		past_title(&past, n * STEP, text);
		if (n % 4)
			continue;
		TEST_ASSERT_EQUAL_INT(0, history_writer_tick(past.writer, n * STEP));
		if (written() > (commit_count ? commits[commit_count - 1].values : 0)) {
			commits[commit_count].step = power_file_steps();
			commits[commit_count++].values = written();
		}
	}
	past_end(&past, VALUES * STEP + STEP);
	power_file_end();
}

/* How many values were certainly on the disk when the power went. */
static int committed(size_t step)
{
	int values = 0;

	for (int i = 0; i < commit_count && commits[i].step <= step; i++)
		values = commits[i].values;
	return values;
}

/* How many values it has. */
static int check(void)
{
	struct ows_history_item *items;
	int count;

	past_begin(&past, PAST_DAY, PAST_NOON, true);
	past_room(&past, PAST_DAY + PAST_S, -1);
	past_end(&past, PAST_DAY + 2 * PAST_S);
	TEST_ASSERT_EQUAL_STRING("", past.said);
	TEST_ASSERT_EQUAL_INT64(1, past_ask(&past, "select count(*) = 1 and min(quick_check) = 'ok'"
	                                           " from pragma_quick_check"));
	count = past_items(&past, PAST_ROOM, &items);
	/* at the end: a gap since the cut, the new value, and the end of it */
	TEST_ASSERT_EQUAL_DOUBLE(-1, items[count - 2].number);
	count -= 2;
	if (count)
		TEST_ASSERT_EQUAL_INT(0, items[--count].known);
	for (int i = 0; i < count; i++) {
		TEST_ASSERT_TRUE(items[i].known);
		TEST_ASSERT_INT64_WITHIN(5000, (i + 1) * STEP, items[i].boot_ns);
		TEST_ASSERT_EQUAL_DOUBLE(value_of(i + 1), items[i].number);
	}
	if (count) /* nothing looks as if it had lasted */
		TEST_ASSERT_TRUE(items[count].boot_ns < (count + 1) * STEP + 1000 * PAST_S);
	return count;
}

static void test_at_any_moment_the_file_has_a_prefix_of_what_was_recorded(void)
{
	const char *wanted = getenv("POWER_CUTS");
	int cuts = wanted ? atoi(wanted) : 40;
	size_t steps;

	record();
	steps = power_file_steps();
	TEST_ASSERT_TRUE(steps > 1000 && commit_count > 100);
	for (int i = 0; i < cuts; i++) {
		/* the making of the file is a small part of it, and has the most kinds of writes */
		size_t step = past_random((unsigned)(i % 4 ? steps : 60));
		char at[120];
		int count;

		past_make(&past);
		power_file_cut(past.directory, "history.sqlite", step, past_random);
		count = check();
		snprintf(at, sizeof(at), "cut in step %zu of %zu: %d values, %d were committed",
		         step, steps, count, committed(step));
		TEST_ASSERT_TRUE_MESSAGE(count >= committed(step) && count <= VALUES, at);
	}
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_at_any_moment_the_file_has_a_prefix_of_what_was_recorded);
	return UNITY_END();
}
