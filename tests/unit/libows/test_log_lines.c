/* SPDX-License-Identifier: MIT */
/* What libows returns of owsd's log, also when the ring has gone round, and after a reload. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "src/memory/shm/entries.h"
#include "tests/unit/aid/instance.h"

static const struct instance_signal signals[] = {
	{"room", "/28.551DDF030000/temperature", OWS_DOUBLE, false, 0, NULL},
};
static struct instance in;
static struct ows *h;

void setUp(void)
{
	instance_start(&in, "log", signals, 1);
	TEST_ASSERT_EQUAL(0, ows_open(in.name, OWS_READ, &h));
}

void tearDown(void)
{
	ows_close(h);
	instance_end(&in);
}

static void put(uint32_t n)
{
	char text[32];
	int len = snprintf(text, sizeof(text), "line %u and rest", n);

	image_log(&in.image, 1000 + n, 4, text, (size_t)len - strlen(" and rest"));
}

static void has(uint32_t n)
{
	char text[32];
	struct ows_log_line line;

	snprintf(text, sizeof(text), "line %u", n);
	TEST_ASSERT_EQUAL(0, ows_log_line(h, n, &line));
	TEST_ASSERT_EQUAL(n, line.number);
	TEST_ASSERT_EQUAL(4, line.level);
	TEST_ASSERT_EQUAL_INT64(1000 + n, line.time_ns);
	TEST_ASSERT_EQUAL_STRING(text, line.text);
}

static void test_lines_count_from_one_and_the_newest_are_kept(void)
{
	struct ows_log_line line;
	uint32_t kept = in.image.log_lines;

	TEST_ASSERT_GREATER_THAN(2, kept);
	TEST_ASSERT_EQUAL(0, ows_log_last(h));
	TEST_ASSERT_EQUAL(-ENOENT, ows_log_line(h, 0, &line));
	TEST_ASSERT_EQUAL(-ENOENT, ows_log_line(h, 1, &line));
	for (uint32_t n = 1; n <= 3 * kept; n++) {
		put(n);
		TEST_ASSERT_EQUAL(n, ows_log_last(h));
		has(n);
	}
	has(2 * kept + 1);
	TEST_ASSERT_EQUAL(-ENOENT, ows_log_line(h, 2 * kept, &line));
	TEST_ASSERT_EQUAL(-ENOENT, ows_log_line(h, 3 * kept + 1, &line));
}

static void test_a_long_line_is_cut_and_ends(void)
{
	struct ows_log_line line;
	char big[400];

	memset(big, 'x', sizeof(big));
	image_log(&in.image, 1, 3, big, sizeof(big));
	TEST_ASSERT_EQUAL(0, ows_log_line(h, 1, &line));
	TEST_ASSERT_EQUAL_size_t(sizeof(line.text) - 1, strlen(line.text));
	memset(in.image.log[1].text, 'y', sizeof(in.image.log[1].text)); /* a lie of the image */
	TEST_ASSERT_EQUAL(0, ows_log_line(h, 1, &line));
	TEST_ASSERT_EQUAL_size_t(sizeof(line.text) - 1, strlen(line.text));
}

static void test_an_entry_that_owsd_died_in_is_skipped(void)
{
	struct ows_log_line line;

	put(1);
	put(2);
	in.image.log[2].seq++;
	TEST_ASSERT_EQUAL(-EIO, ows_log_line(h, 2, &line));
	TEST_ASSERT_EQUAL(1, ows_log_last(h));
	has(1);
}

static void test_a_reload_goes_on_with_the_numbers(void)
{
	struct instance next;

	put(1);
	put(2);
	instance_make(&next, "log_next", 2, in.start_ns, signals, 1);
	image_carry_log(&next.image, &in.image);
	image_log(&next.image, 7, 4, "after", 5);
	TEST_ASSERT_EQUAL(3, next.image.log[3].number);
	TEST_ASSERT_EQUAL_STRING("line 1", next.image.log[1].text);
	instance_leave(&next);
}

static void test_a_refused_reload_is_known_with_its_reason_until_the_next_image(void)
{
	struct ows_log_line line;

	TEST_ASSERT_EQUAL(-ENOENT, ows_refused_reload(h, &line));
	image_refused(&in.image, 5, true, "a.rio:1:1: no and rest", strlen("a.rio:1:1: no"));
	TEST_ASSERT_EQUAL(0, ows_refused_reload(h, &line));
	TEST_ASSERT_EQUAL_UINT(4, line.level);
	image_refused(&in.image, 7, false, "a.rio:2:1: no and rest", strlen("a.rio:2:1: no"));
	TEST_ASSERT_EQUAL(0, ows_refused_reload(h, &line));
	TEST_ASSERT_EQUAL_UINT(3, line.level);
	TEST_ASSERT_EQUAL_UINT(2, line.number);
	TEST_ASSERT_EQUAL_INT64(7, line.time_ns);
	TEST_ASSERT_EQUAL_STRING("a.rio:2:1: no", line.text);
	in.image.refused->seq++; /* owsd died in it */
	TEST_ASSERT_EQUAL(-EIO, ows_refused_reload(h, &line));
}

static void test_a_long_reason_is_cut_and_ends(void)
{
	struct ows_log_line line;
	char why[2 * OWS_LINE] = "";

	memset(why, 'x', sizeof(why) - 1);
	image_refused(&in.image, 5, false, why, sizeof(why));
	TEST_ASSERT_EQUAL(0, ows_refused_reload(h, &line));
	TEST_ASSERT_EQUAL_UINT(OWS_LINE - 1, strlen(line.text));
	image_note(&in.image, 1, 5, why);
	TEST_ASSERT_EQUAL(0, ows_target_note(h, 1, &line));
	TEST_ASSERT_EQUAL_UINT(OWS_LINE - 1, strlen(line.text));
}

static void test_each_target_has_a_note_until_there_is_nothing_to_say(void)
{
	struct ows_log_line line;

	TEST_ASSERT_EQUAL(-ENOENT, ows_target_note(h, 1, &line));
	image_note(&in.image, 1, 7, "the adapter is gone");
	TEST_ASSERT_EQUAL(0, ows_target_note(h, 1, &line));
	TEST_ASSERT_EQUAL_INT64(7, line.time_ns);
	TEST_ASSERT_EQUAL_STRING("the adapter is gone", line.text);
	TEST_ASSERT_EQUAL(-ENOENT, ows_target_note(h, 0, &line));
	TEST_ASSERT_EQUAL(-ENOENT, ows_target_note(h, 2, &line));
	TEST_ASSERT_EQUAL(-ENOENT, ows_target_note(h, -1, &line));
	image_note(&in.image, 1, 8, "");
	TEST_ASSERT_EQUAL(-ENOENT, ows_target_note(h, 1, &line));
	in.image.notes[1].seq++; /* owsd died in it */
	TEST_ASSERT_EQUAL(-EIO, ows_target_note(h, 1, &line));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_lines_count_from_one_and_the_newest_are_kept);
	RUN_TEST(test_a_long_line_is_cut_and_ends);
	RUN_TEST(test_an_entry_that_owsd_died_in_is_skipped);
	RUN_TEST(test_a_reload_goes_on_with_the_numbers);
	RUN_TEST(test_a_refused_reload_is_known_with_its_reason_until_the_next_image);
	RUN_TEST(test_a_long_reason_is_cut_and_ends);
	RUN_TEST(test_each_target_has_a_note_until_there_is_nothing_to_say);
	return UNITY_END();
}
