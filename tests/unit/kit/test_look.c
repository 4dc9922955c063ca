/* SPDX-License-Identifier: MIT */
/* Tests of what a face learns of owsd: presence, changes, reloads, losses. */
#include <stdio.h>
#include <string.h>
#include <time.h>

#include "unity.h"

#include "hal/base/time.h"
#include "src/faces/kit/look.h"
#include "src/ground/signal/value.h"
#include "src/memory/shm/entries.h"
#include "tests/unit/aid/folder.h"
#include "tests/unit/aid/instance.h"

static const struct instance_signal before[] = {
	{"a", "/28.1/temperature", OWS_DOUBLE, false, 0},
	{"b", "/29.1/PIO.0", OWS_BOOL, true, 0},
};
static const struct instance_signal after[] = {
	{"b", "/29.1/PIO.0", OWS_BOOL, true, 0},
};

static struct instance in;
static char happened[512];     /* words, each with a blank after it */
static struct ows_alarm alarm; /* the last one that came */

static void note(const char *word)
{
	size_t len = strlen(happened);

	snprintf(happened + len, sizeof(happened) - len, "%s ", word);
}

static void take_event(struct face *face, const struct face_event *event)
{
	static const char *const words[] = {
		[FACE_FOUND] = "found",
		[FACE_RELOADED] = "reloaded",
		[FACE_LOST] = "lost",
		[FACE_OVERRUN] = "overrun",
		[FACE_FILE] = "file",
		[FACE_ALARM] = "alarm",
		[FACE_COMMAND] = "command",
		[FACE_ENTRIES_LOST] = "entries-lost",
		[FACE_DESCRIPTOR] = "descriptor",
	};

	(void)face;
	note(words[event->news]);
	if (event->news == FACE_ALARM)
		alarm = *event->alarm;
}

static void take_changes(struct face *face, const int *signals, int n)
{
	struct ows_info info;

	TEST_ASSERT_TRUE(face->live);
	if (!signals)
		note("all");
	for (int i = 0; i < n; i++)
		note(ows_info(face->ows, signals[i], &info) == 0 ? info.name : "?");
}

static const struct face_ops ops = {
	.program = "test", .changes = take_changes, .event = take_event};
static const struct face_arguments arguments = {.program = "test", .file = "/nowhere/test.rio"};
static struct face_arguments named;
static struct face face;

void setUp(void)
{
	named = arguments;
	named.instance = "face_look";
	face = (struct face){.ops = &ops, .arguments = &named, .tick_ns = INT64_MAX};
	memset(&in, 0, sizeof(in));
	*happened = '\0';
}

static void start(void)
{
	instance_start(&in, "face_look", before, 2);
	named.instance = in.name;
}

void tearDown(void)
{
	ows_close(face.ows);
	if (in.count)
		instance_end(&in);
}

/* Look until something has happened, a minute at most; returns what. */
static const char *looked(void)
{
	static char words[sizeof(happened)];
	const struct timespec pause = {.tv_nsec = 1000000};

	for (int i = 0; i < 60000 && !*happened; i++) {
		look(&face, ows_now());
		if (!*happened)
			nanosleep(&pause, NULL); /* pace */
	}
	memcpy(words, happened, sizeof(words));
	*happened = '\0';
	return words;
}

static void looks_quiet(void)
{
	for (int i = 0; i < 20; i++)
		look(&face, ows_now());
	TEST_ASSERT_EQUAL_STRING("", happened);
}

static void test_an_owsd_that_is_not_there_is_found_when_it_comes(void)
{
	looks_quiet();
	TEST_ASSERT_NULL(face.ows);
	start();
	face.open_ns = 0;
	TEST_ASSERT_EQUAL_STRING("found all ", looked());
	TEST_ASSERT_TRUE(face.live);
	looks_quiet();
}

static void test_changes_come_once_by_index(void)
{
	start();
	looked();
	instance_put(&in, 2, 1, ows_now());
	instance_put_double(&in, 1, 20.5, ows_now());
	instance_put_double(&in, 1, 21, ows_now());
	TEST_ASSERT_EQUAL_STRING("b a ", looked());
	looks_quiet();
}

static void test_the_descriptor_is_ready_when_something_changed(void)
{
	start();
	looked();
	TEST_ASSERT_TRUE(look_descriptor(&face, ows_now()) >= 0);
	/* the pace of the face: what comes within it comes at once */
	face.pace_ns = NS_PER_S;
	instance_put(&in, 2, 1, ows_now());
	TEST_ASSERT_EQUAL_STRING("b ", looked());
	TEST_ASSERT_EQUAL_INT(-1, look_descriptor(&face, ows_now()));
	instance_put(&in, 2, 0, ows_now());
	looks_quiet();
	TEST_ASSERT_EQUAL_INT64(face.look_ns, look_next(&face, face.look_ns - 1));
	look(&face, face.look_ns);
	TEST_ASSERT_EQUAL_STRING("b ", happened);
}

static void test_a_reload_is_no_loss(void)
{
	start();
	looked();
	instance_reload(&in, after, 1);
	TEST_ASSERT_EQUAL_STRING("reloaded all ", looked());
	TEST_ASSERT_EQUAL_INT(1, ows_count(face.ows));
	instance_lives_on(&in);
	instance_put(&in, 1, 1, ows_now());
	TEST_ASSERT_EQUAL_STRING("b ", looked());
}

/* A tick may come between the opening of an image and the first look at it. */
static void test_between_a_new_image_and_its_first_look_nothing_is_current(void)
{
	start();
	looked();
	looks_quiet();
	TEST_ASSERT_TRUE(look_is_current(&face));
	instance_reload(&in, after, 1);
	/* as a look that ends there leaves it */
	TEST_ASSERT_EQUAL_INT(0, ows_reopen(face.ows));
	face.fresh = true;
	TEST_ASSERT_EQUAL_INT(1, ows_count(face.ows));
	TEST_ASSERT_TRUE(face.live);
	TEST_ASSERT_FALSE(look_is_current(&face));
	TEST_ASSERT_EQUAL_STRING("reloaded all ", looked());
	TEST_ASSERT_TRUE(look_is_current(&face));
}

static void test_an_image_that_is_gone_is_not_current(void)
{
	int64_t looked_ns;

	start();
	looked();
	looks_quiet();
	looked_ns = face.looked_ns;
	image_state(&in.image, OWS_STATE_RETIRED);
	remove(folder_file(in.name, "image"));
	looks_quiet();
	TEST_ASSERT_TRUE(face.live);
	TEST_ASSERT_FALSE(look_is_current(&face));
	TEST_ASSERT_EQUAL_INT64(looked_ns, face.looked_ns);
	/* not back within a second */
	face.stale_ns -= 2 * NS_PER_S;
	TEST_ASSERT_EQUAL_STRING("lost ", looked());
	TEST_ASSERT_FALSE(look_is_current(&face));
}

static void test_a_look_that_the_pace_puts_off_has_not_looked(void)
{
	int64_t now_ns;

	start();
	looked();
	face.pace_ns = 10 * NS_PER_S;
	instance_put(&in, 2, 1, ows_now());
	now_ns = ows_now();
	look(&face, now_ns);
	TEST_ASSERT_EQUAL_STRING("b ", happened);
	TEST_ASSERT_EQUAL_INT64(now_ns, face.looked_ns);
	*happened = '\0';
	instance_put(&in, 2, 0, ows_now());
	look(&face, ows_now());
	TEST_ASSERT_EQUAL_STRING("", happened);
	TEST_ASSERT_EQUAL_INT64(now_ns, face.looked_ns);
	look(&face, face.look_ns);
	TEST_ASSERT_EQUAL_STRING("b ", happened);
	TEST_ASSERT_TRUE(face.looked_ns > now_ns);
}

static void test_an_owsd_that_ends_is_lost_once_and_the_next_is_found(void)
{
	start();
	looked();
	image_state(&in.image, OWS_STATE_STOPPED);
	TEST_ASSERT_EQUAL_STRING("lost ", looked());
	TEST_ASSERT_FALSE(face.live);
	looks_quiet();
	instance_end(&in);
	start();
	TEST_ASSERT_EQUAL_STRING("found all ", looked());
	looks_quiet();
}

static void test_an_owsd_that_hangs_is_lost_and_found_when_its_heart_beats_again(void)
{
	start();
	looked();
	/* as if the last beat had been a minute ago */
	instance_beat(&in, ows_now() - 60 * NS_PER_S, 0);
	TEST_ASSERT_EQUAL_STRING("lost ", looked());
	instance_put(&in, 2, 1, ows_now());
	looks_quiet();
	instance_lives_on(&in);
	TEST_ASSERT_EQUAL_STRING("found all ", looked());
}

/*
 * ows_changes() and ows_daemon() look at the heart one after the other: a beat that comes between
 * them, or the end of its time, gives two answers, and what changes comes once.
 */
static void test_an_owsd_that_was_dead_for_one_question_alone_is_found(void)
{
	start();
	looked();
	looks_quiet();
	/* as a look leaves it that was told of a change, and found no heart that beats */
	face.live = false;
	TEST_ASSERT_EQUAL_STRING("found all ", looked());
	face.live = false;
	face.fresh = true;
	TEST_ASSERT_EQUAL_STRING("found all ", looked());
	looks_quiet();
}

static void test_an_image_that_was_opened_again_though_it_is_the_present_one_is_looked_at(void)
{
	start();
	looked();
	looks_quiet();
	TEST_ASSERT_EQUAL_INT(0, ows_reopen(face.ows));
	face.fresh = true;
	TEST_ASSERT_EQUAL_STRING("reloaded all ", looked());
	TEST_ASSERT_TRUE(look_is_current(&face));
	looks_quiet();
}

/* The loop's time is older than that by which the changes are looked at. */
static void test_an_owsd_that_dies_between_two_looks_at_the_time_is_lost(void)
{
	start();
	looked();
	instance_beat(&in, ows_now() - 60 * NS_PER_S, 0);
	face.look_ns = 0;
	look(&face, ows_now() - 60 * NS_PER_S);
	TEST_ASSERT_EQUAL_STRING("lost ", happened);
	TEST_ASSERT_FALSE(face.live);
}

static void test_more_changes_than_are_kept_are_an_overrun(void)
{
	start();
	looked();
	for (int i = 0; i < 100000; i++)
		instance_put(&in, 2, i % 2, ows_now());
	TEST_ASSERT_EQUAL_STRING("overrun all ", looked());
	TEST_ASSERT_TRUE(face.live);
}

/* Of the device of signal a: owsd reads the value after it a moment later. */
static uint32_t alarm_of_a(void)
{
	return image_alarm(&in.image, &(struct ows_journal_entry){.record = 1,
	                                                          .kind = OWS_ALARM_DEVICE,
	                                                          .event = OWS_ALARM_RAISED,
	                                                          .occurred_ns = ows_now()});
}

static void test_an_alarm_waits_for_its_value_and_those_behind_it_in_their_order(void)
{
	uint32_t number;

	start();
	looked();
	alarm_of_a();
	TEST_ASSERT_EQUAL_STRING("alarm ", looked()); /* a face that says nothing of it */
	TEST_ASSERT_FALSE(alarm.has_after);
	face.after_ns = 3600 * NS_PER_S;
	number = alarm_of_a();
	image_alarm(&in.image, &(struct ows_journal_entry){.record = 2,
	                                                   .kind = OWS_ALARM_H,
	                                                   .event = OWS_ALARM_RAISED,
	                                                   .occurred_ns = ows_now()});
	looks_quiet();
	image_alarm_after(&in.image, number, value_of_double(21.5));
	look(&face, face.look_ns);
	TEST_ASSERT_EQUAL_STRING("alarm alarm ", looked());
	TEST_ASSERT_EQUAL_INT(1, alarm.signal);
	alarm_of_a();
	looks_quiet();
	image_alarm_after(&in.image, number + 2, value_of_double(22.5));
	TEST_ASSERT_EQUAL_STRING("alarm ", looked());
	TEST_ASSERT_TRUE(alarm.has_after);
	TEST_ASSERT_EQUAL_DOUBLE(22.5, alarm.after);
}

static void test_an_alarm_without_a_value_comes_all_the_same(void)
{
	start();
	looked();
	face.after_ns = 3600 * NS_PER_S;
	alarm_of_a();
	looks_quiet();
	/* after its time */
	face.after_ns = 1;
	TEST_ASSERT_EQUAL_STRING("alarm ", looked());
	face.after_ns = 3600 * NS_PER_S;
	/* before others are lost behind it */
	for (int i = 0; i < 130; i++)
		alarm_of_a();
	TEST_ASSERT_EQUAL_STRING("alarm alarm alarm ", looked());
	/* when owsd ends */
	image_state(&in.image, OWS_STATE_STOPPED);
	while (face.live)
		looked();
	TEST_ASSERT_EQUAL_UINT32(ows_alarm_count(face.ows), face.next_alarm);
}

static void test_a_dead_image_is_no_owsd(void)
{
	start();
	image_state(&in.image, OWS_STATE_STOPPED);
	looks_quiet();
	TEST_ASSERT_FALSE(face.live);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_an_owsd_that_is_not_there_is_found_when_it_comes);
	RUN_TEST(test_changes_come_once_by_index);
	RUN_TEST(test_the_descriptor_is_ready_when_something_changed);
	RUN_TEST(test_a_reload_is_no_loss);
	RUN_TEST(test_between_a_new_image_and_its_first_look_nothing_is_current);
	RUN_TEST(test_an_image_that_is_gone_is_not_current);
	RUN_TEST(test_a_look_that_the_pace_puts_off_has_not_looked);
	RUN_TEST(test_an_owsd_that_ends_is_lost_once_and_the_next_is_found);
	RUN_TEST(test_an_owsd_that_hangs_is_lost_and_found_when_its_heart_beats_again);
	RUN_TEST(test_an_owsd_that_was_dead_for_one_question_alone_is_found);
	RUN_TEST(test_an_image_that_was_opened_again_though_it_is_the_present_one_is_looked_at);
	RUN_TEST(test_an_owsd_that_dies_between_two_looks_at_the_time_is_lost);
	RUN_TEST(test_more_changes_than_are_kept_are_an_overrun);
	RUN_TEST(test_an_alarm_waits_for_its_value_and_those_behind_it_in_their_order);
	RUN_TEST(test_an_alarm_without_a_value_comes_all_the_same);
	RUN_TEST(test_a_dead_image_is_no_owsd);
	return UNITY_END();
}
