/* SPDX-License-Identifier: MIT */
/* Tests of the pieces of events that streams share. */
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "hal/base/time.h"
#include "src/faces/web/pace.h"

#define NOW_NS (1000 * NS_PER_S)

static struct shared shared;

void setUp(void)
{
}

void tearDown(void)
{
	shared_forget(&shared);
}

static struct position at(uint64_t seen, uint64_t until, bool within)
{
	return (struct position){.generation = 1, .seen = seen, .until = until, .within = within};
}

static void keep(uint64_t seen, uint64_t until, const char *text, size_t len)
{
	struct position from = at(seen, until, false), to = at(until, until, false);

	shared_keep(&shared, &from, &to, NOW_NS, text, len);
}

/* What a stream of that position gets then, and where it is led. */
static const char *found(struct position position, int64_t now_ns, uint64_t leads_to)
{
	size_t len = 0;
	const char *text = shared_find(&shared, &position, now_ns, &len);

	TEST_ASSERT_EQUAL_UINT64(leads_to, position.seen);
	if (text)
		TEST_ASSERT_EQUAL_size_t(len, strlen(text));
	return text;
}

static void test_streams_that_know_the_same_get_the_same(void)
{
	keep(10, 20, "a piece, and more", 7);
	TEST_ASSERT_EQUAL_STRING("a piece", found(at(10, 20, false), NOW_NS, 20));
	TEST_ASSERT_EQUAL_STRING("a piece", found(at(10, 20, false), NOW_NS, 20));
}

static void test_a_stream_that_knows_something_else_gets_none_of_it(void)
{
	struct position other = at(10, 20, false);

	keep(10, 20, "a piece", 7);
	TEST_ASSERT_NULL(found(at(11, 20, false), NOW_NS, 11));
	TEST_ASSERT_NULL(found(at(10, 21, false), NOW_NS, 10));
	TEST_ASSERT_NULL(found(at(10, 20, true), NOW_NS, 10));
	other.generation = 2;
	TEST_ASSERT_NULL(found(other, NOW_NS, 10));
	other = at(10, 20, false);
	other.some = true;
	TEST_ASSERT_NULL(found(other, NOW_NS, 10));
}

static void test_an_old_piece_is_not_given_as_its_ages_are_wrong(void)
{
	keep(10, 20, "a piece", 7);
	TEST_ASSERT_NOT_NULL(found(at(10, 20, false), NOW_NS + 20 * NS_PER_MS, 20));
	TEST_ASSERT_NULL(found(at(10, 20, false), NOW_NS + 21 * NS_PER_MS, 10));
}

static void test_a_few_of_the_last_ones_are_kept(void)
{
	char text[8];

	for (uint64_t seen = 0; seen < 9; seen++) {
		snprintf(text, sizeof(text), "%u", (unsigned)seen);
		keep(seen, seen + 1, text, 1);
	}
	TEST_ASSERT_NULL(found(at(4, 5, false), NOW_NS, 4));
	TEST_ASSERT_EQUAL_STRING("5", found(at(5, 6, false), NOW_NS, 6));
	TEST_ASSERT_EQUAL_STRING("8", found(at(8, 9, false), NOW_NS, 9));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_streams_that_know_the_same_get_the_same);
	RUN_TEST(test_a_stream_that_knows_something_else_gets_none_of_it);
	RUN_TEST(test_an_old_piece_is_not_given_as_its_ages_are_wrong);
	RUN_TEST(test_a_few_of_the_last_ones_are_kept);
	return UNITY_END();
}
