/* SPDX-License-Identifier: MIT */
/* Tests of times and spans as owsctl prints them. */
#include <stdlib.h>
#include <time.h>

#include "unity.h"

#include "src/libows/ows.h"
#include "src/show/when.h"

#define SECOND INT64_C(1000000000)

void setUp(void)
{
}

void tearDown(void)
{
}

static char text[WHEN_TEXT];

static void zone(const char *name)
{
	setenv("TZ", name, 1);
	tzset();
}

static void test_a_time_is_local_with_its_offset(void)
{
	struct when now = {.boot = 10 * SECOND, .wall = 1700000000 * SECOND + 250000000};

	zone("UTC0");
	TEST_ASSERT_EQUAL_STRING("2023-11-14T22:13:20.250+00:00", when_iso(&now, now.boot, text));
	zone("XXX-5:30");
	TEST_ASSERT_EQUAL_STRING("2023-11-15T03:43:20.250+05:30", when_iso(&now, now.boot, text));
	zone("XXX3");
	TEST_ASSERT_EQUAL_STRING("2023-11-14T19:13:20.250-03:00", when_iso(&now, now.boot, text));
}

static void test_a_time_before_now_is_as_much_earlier(void)
{
	struct when now = {.boot = 10 * SECOND, .wall = 1700000000 * SECOND};

	zone("UTC0");
	TEST_ASSERT_EQUAL_STRING("2023-11-14T22:13:18.500+00:00",
	                         when_iso(&now, 8 * SECOND + SECOND / 2, text));
}

static void test_a_time_that_cannot_be_is_a_question_mark(void)
{
	struct when now = {.boot = 10 * SECOND, .wall = 1 * SECOND};

	TEST_ASSERT_EQUAL_STRING("?", when_iso(&now, 1 * SECOND, text));
}

static void test_now_is_one_moment_on_both_clocks(void)
{
	int64_t before = ows_now();
	struct when now = when_now();

	TEST_ASSERT_TRUE(now.boot >= before && now.boot <= ows_now());
	TEST_ASSERT_TRUE(now.wall > 1700000000 * SECOND);
}

static void test_spans_are_short(void)
{
	TEST_ASSERT_EQUAL_STRING("0.0s", when_span(-5, text));
	TEST_ASSERT_EQUAL_STRING("0.4s", when_span(499999999, text));
	TEST_ASSERT_EQUAL_STRING("9.9s", when_span(10 * SECOND - 1, text));
	TEST_ASSERT_EQUAL_STRING("10s", when_span(10 * SECOND, text));
	TEST_ASSERT_EQUAL_STRING("119s", when_span(119 * SECOND, text));
	TEST_ASSERT_EQUAL_STRING("2m", when_span(120 * SECOND, text));
	TEST_ASSERT_EQUAL_STRING("2h", when_span(7200 * SECOND, text));
	TEST_ASSERT_EQUAL_STRING("2d", when_span(48 * 3600 * SECOND, text));
	TEST_ASSERT_EQUAL_STRING("106751d", when_span(INT64_MAX, text));
}

static void test_a_moment_is_so_long_ago_or_a_local_time(void)
{
	static const struct {
		const char *text;
		int64_t seconds;
	} good[] = {
		{"90", 1699999910},         {"1.5m", 1699999910},
		{"24h", 1699913600},        {"7d", 1699395200},
		{"3660d", 1383776000},      {"36500d", 0}, /* not before 1970 */
		{"2023-11-14", 1699920000}, {"2023-11-14T22:13", 1700000000 - 20},
		{"1970-01-01", 0},          {"2023-11-14T22:13:20", 1700000000},
		{"1999-12-31", 946598400},  {"2023-11-14 22:13:20", 1700000000},
	};
	static const char *const bad[] = {"",          "soon",
	                                  "-5",        "0",
	                                  "5w",        "2023-11",
	                                  "7dd",       "1960-01-01",
	                                  "1e9d",      "2023-13-01",
	                                  "nan",       "2023-11-14T",
	                                  "inf",       "2023-11-14T22:13:20Z+1",
	                                  "9999-12-31"};
	struct when now = {.boot = 10 * SECOND, .wall = 1700000000 * SECOND};
	int64_t ns;

	zone("UTC0");
	for (size_t i = 0; i < sizeof(good) / sizeof(good[0]); i++) {
		TEST_ASSERT_TRUE_MESSAGE(when_moment(&now, good[i].text, &ns), good[i].text);
		TEST_ASSERT_EQUAL_INT64_MESSAGE(good[i].seconds * SECOND, ns, good[i].text);
	}
	for (size_t i = 0; i < sizeof(bad) / sizeof(bad[0]); i++)
		TEST_ASSERT_FALSE_MESSAGE(when_moment(&now, bad[i], &ns), bad[i]);
	zone("XXX3");
	TEST_ASSERT_TRUE(when_moment(&now, "2023-11-14T19:13:20", &ns));
	TEST_ASSERT_EQUAL_INT64(1700000000 * SECOND, ns);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_time_is_local_with_its_offset);
	RUN_TEST(test_a_time_before_now_is_as_much_earlier);
	RUN_TEST(test_a_time_that_cannot_be_is_a_question_mark);
	RUN_TEST(test_now_is_one_moment_on_both_clocks);
	RUN_TEST(test_spans_are_short);
	RUN_TEST(test_a_moment_is_so_long_ago_or_a_local_time);
	return UNITY_END();
}
