/* SPDX-License-Identifier: MIT */
/* Tests of times and spans as owsctl prints them. */
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "unity.h"

#include "src/faces/show/when.h"
#include "src/public/ows.h"

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

static const struct when present = {.boot = 10 * SECOND, .wall = 1700000000 * SECOND};

static void is_moment(const char *word, int64_t want_ns)
{
	int64_t ns = -1;
	const char *why = when_moment(&present, word, &ns);

	TEST_ASSERT_NULL_MESSAGE(why, word);
	TEST_ASSERT_EQUAL_INT64_MESSAGE(want_ns, ns, word);
}

static void is_refused(const char *word, const char *reason)
{
	int64_t ns = -1;
	const char *why = when_moment(&present, word, &ns);

	TEST_ASSERT_NOT_NULL_MESSAGE(why, word);
	TEST_ASSERT_NOT_NULL_MESSAGE(strstr(why, reason), why);
	TEST_ASSERT_EQUAL_INT64_MESSAGE(-1, ns, word);
}

static void test_a_moment_is_so_long_ago_or_a_local_time(void)
{
	static const struct {
		const char *text;
		int64_t seconds;
	} good[] = {
		{"90", 1699999910},
		{"1.5m", 1699999910},
		{"24h", 1699913600},
		{"7d", 1699395200},
		{"3660d", 1383776000},
		{"36500d", 0}, /* not before 1970 */
		{"5m ago", 1699999700},
		{"5 minutes ago", 1699999700},
		{"1 hour ago", 1699996400},
		{"90 ago", 1699999910},
		{"5min", 1699999700},
		{"now", 1700000000},
		{"today", 1699920000},
		{"yesterday", 1699833600},
		{"2023-11-14", 1699920000},
		{"2023-11-14T22:13", 1700000000 - 20},
		{"1970-01-01", 0},
		{"2023-11-14T22:13:20", 1700000000},
		{"1999-12-31", 946598400},
		{"2023-11-14 22:13:20", 1700000000},
		{"2024-02-29", 1709164800},
		{"2114-12-31T23:59", 4575743940},
		{"2023-11-14T22:13:20Z", 1700000000},
		{"2023-11-14T22:13Z", 1700000000 - 20},
		{"2023-11-14T19:13:20-03:00", 1700000000},
		{"2023-11-15T03:43:20+0530", 1700000000},
	};

	zone("UTC0");
	for (size_t i = 0; i < sizeof(good) / sizeof(good[0]); i++)
		is_moment(good[i].text, good[i].seconds * SECOND);
	is_moment("2023-11-14T22:13:20.250Z", present.wall + SECOND / 4);
	is_moment("2023-11-14T22:13:20.000000001", present.wall + 1);
	zone("XXX3");
	is_moment("2023-11-14T19:13:20", 1700000000 * SECOND);
	is_moment("2023-11-14T22:13:20Z", 1700000000 * SECOND);
	is_moment("today", 1699930800 * SECOND);
	is_moment("yesterday", 1699844400 * SECOND);
}

static void test_what_is_no_moment_is_refused_with_what_is_wrong(void)
{
	static const char *const none[] = {
		"",
		"soon",
		"-5",
		"0",
		"5w",
		"2023-11",
		"7dd",
		"1e9d",
		"2023-13-01",
		"nan",
		"inf",
		"2023-11-14T",
		"2023-11-14T22:13:20Z+1",
		"2023-11-14T22:13:20.",
		"ago",
		"m ago",
		"5m  ago now",
		"2023-11-14T22:13:20.1.2",
		"2023-11-14 +01:00",
		"todays",
		"now ago",
		"2023-11-32",
	};
	static const char *const no_day[] = {"2026-02-30", "2023-02-29", "2023-04-31",
	                                     "2026-02-30T10:00Z", "2023-11-14T22:13:60"};
	static const char *const beyond[] = {"2115-01-01", "2200-01-01", "9999-12-31", "1960-01-01",
	                                     "0001-01-01"};

	zone("UTC0");
	for (size_t i = 0; i < sizeof(none) / sizeof(none[0]); i++)
		is_refused(none[i], "expected a time such as 24h, \"5m ago\"");
	for (size_t i = 0; i < sizeof(no_day) / sizeof(no_day[0]); i++)
		is_refused(no_day[i], "no such");
	for (size_t i = 0; i < sizeof(beyond) / sizeof(beyond[0]); i++)
		is_refused(beyond[i], "1970 to 2114");
}

static void test_a_time_that_was_printed_is_a_moment(void)
{
	static const char *const zones[] = {"UTC0", "XXX-5:30", "CET-1CEST,M3.5.0,M10.5.0/3"};

	for (size_t i = 0; i < sizeof(zones) / sizeof(zones[0]); i++) {
		zone(zones[i]);
		/* an hour of each day of a year: both hours of the night in October, too */
		for (int64_t hour = 0; hour < 366 * 24; hour += 23) {
			int64_t wall = present.wall + hour * 3600 * SECOND + 40 * SECOND / 1000;

			when_iso(&present, present.boot + (wall - present.wall), text);
			is_moment(text, wall);
		}
	}
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
	RUN_TEST(test_what_is_no_moment_is_refused_with_what_is_wrong);
	RUN_TEST(test_a_time_that_was_printed_is_a_moment);
	return UNITY_END();
}
