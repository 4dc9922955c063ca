/* SPDX-License-Identifier: MIT */
/*
 * Consumers of an owsd that was killed, and whose image lost its name before another owsd could
 * mark it.
 */
#include <errno.h>
#include <pthread.h>
#include <stdio.h>
#include <time.h>

#include "unity.h"

#include "tests/unit/aid/asleep.h"
#include "tests/unit/aid/folder.h"
#include "tests/unit/aid/instance.h"

static const struct instance_signal signals[] = {
	{"room", "/28.1/temperature", OWS_DOUBLE, false, 0},
	{"relay", "/29.1/PIO.0", OWS_BOOL, true, 0},
	{"label", "/23.1/memory", OWS_STRING, true, 0},
};
enum { ROOM = 1, RELAY, LABEL };
#define COUNT 3
#define DEAD (3 * INSTANCE_S) /* since its last beat */

static struct instance first, second;
static bool shown; /* the second is there */
static struct ows *h;
static int room, relay, label;
static int64_t t0; /* the first one's last beat */

/* It was killed as long ago as is said. */
static void kill_first(int64_t ago_ns)
{
	t0 = ows_now() - ago_ns;
	instance_beat(&first, t0, 0);
	instance_put_double(&first, ROOM, 20, t0);
}

void setUp(void)
{
	instance_start(&first, "orphan", signals, COUNT);
	instance_dies_soon(&first);
	shown = false;
	TEST_ASSERT_EQUAL(0, ows_open(first.name, OWS_CONTROL, &h));
	room = ows_find(h, "room");
	relay = ows_find(h, "relay");
	label = ows_find(h, "label");
	kill_first(0);
}

void tearDown(void)
{
	ows_close(h);
	if (shown)
		instance_leave(&second);
	instance_end(&first);
}

static void remove_names(void)
{
	TEST_ASSERT_EQUAL(0, remove(folder_file(first.name, "image")));
	instance_kill(&first);
}

/* The owsd after it, which finds nothing to retire. */
static void start_second(void)
{
	int64_t now = ows_now();

	instance_make(&second, "orphan", 1, now, signals, COUNT);
	instance_lives_on(&second);
	instance_put_double(&second, ROOM, 21, now);
	instance_show(&second);
	shown = true;
}

static void replace(void)
{
	remove_names();
	start_second();
}

/* A look at owsd, and what a reader gets after it. */
static int get(int64_t now_ns)
{
	struct ows_daemon daemon;
	struct ows_value v;

	ows_daemon(h, now_ns, &daemon);
	return ows_get(h, room, now_ns, &v);
}

static int reopen(void)
{
	const struct timespec pause = {.tv_nsec = 1000000};
	int err = -ENOENT;

	for (int i = 0; err == -ENOENT && i < 60000; i++) {
		err = ows_reopen(h);
		if (err)
			nanosleep(&pause, NULL); /* pace */
	}
	return err;
}

static void test_a_reader_of_an_orphan_is_led_to_the_next_owsd(void)
{
	struct ows_value v;

	replace();
	TEST_ASSERT_EQUAL_MESSAGE(0, ows_get(h, room, t0 + DEAD, &v), "a read looks at no name");
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_NO_OWSD, v.quality);
	TEST_ASSERT_EQUAL(-ESTALE, get(t0 + DEAD));
	TEST_ASSERT_EQUAL(-ESTALE, ows_get(h, room, t0 + DEAD, &v));
	TEST_ASSERT_EQUAL_DOUBLE(20, v.number);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_NO_OWSD, v.quality);
	TEST_ASSERT_EQUAL(0, reopen());
	TEST_ASSERT_EQUAL(0, ows_get(h, room, ows_now(), &v));
	TEST_ASSERT_EQUAL_DOUBLE(21, v.number);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, v.quality);
}

static void test_while_the_heart_beats_nobody_looks_at_names(void)
{
	struct ows_value v;

	replace();
	TEST_ASSERT_EQUAL(0, get(t0 + INSTANCE_S));
	TEST_ASSERT_EQUAL(0, ows_get(h, room, t0 + INSTANCE_S, &v));
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, v.quality);
	TEST_ASSERT_EQUAL(-ESTALE, get(t0 + DEAD));
	/* the process was stopped, not dead, and goes on */
	instance_beat(&first, t0 + 4 * INSTANCE_S, 1);
	TEST_ASSERT_EQUAL(0, get(t0 + 4 * INSTANCE_S));
}

static void test_a_name_that_leads_nowhere_yet_is_no_reason_to_reopen(void)
{
	struct ows_value v;

	remove_names();
	TEST_ASSERT_EQUAL(0, get(t0 + DEAD));
	TEST_ASSERT_EQUAL(0, ows_get(h, room, t0 + DEAD, &v));
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_NO_OWSD, v.quality);
	start_second();
	TEST_ASSERT_EQUAL(-ESTALE, get(t0 + DEAD + INSTANCE_S));
}

static void test_a_dead_owsd_whose_names_are_in_place_is_no_orphan(void)
{
	kill_first(DEAD);
	TEST_ASSERT_EQUAL(0, get(t0 + DEAD));
	TEST_ASSERT_EQUAL(0, reopen());
	TEST_ASSERT_EQUAL(0, get(t0 + DEAD));
	TEST_ASSERT_EQUAL_MESSAGE(-ESTALE, ows_set(h, relay, 1, NULL), "it is dead all the same");
}

static void test_names_are_looked_at_once_a_second(void)
{
	TEST_ASSERT_EQUAL(0, get(t0 + DEAD));
	replace();
	TEST_ASSERT_EQUAL(0, get(t0 + DEAD + INSTANCE_S - 1));
	TEST_ASSERT_EQUAL(-ESTALE, get(t0 + DEAD + INSTANCE_S));
	remove_names();
	TEST_ASSERT_EQUAL(-ESTALE, get(t0 + DEAD + 2 * INSTANCE_S - 1));
	TEST_ASSERT_EQUAL(0, get(t0 + DEAD + 2 * INSTANCE_S));
	TEST_ASSERT_EQUAL(0, get(t0 + DEAD)); /* a clock that goes back is looked at anew */
}

static void test_every_way_to_look_at_an_orphan_says_so(void)
{
	int age = ows_find(h, "room_Age");
	struct ows_alarm_state state;
	struct ows_command command;
	struct ows_daemon daemon;
	struct ows_value v;
	char text[64];

	kill_first(DEAD);
	replace();
	TEST_ASSERT_EQUAL(-ESTALE, ows_daemon(h, ows_now(), &daemon));
	TEST_ASSERT_EQUAL(-ESTALE, ows_get_signal(h, 0, ows_now(), &v));
	TEST_ASSERT_EQUAL(-ESTALE, ows_get_text(h, room, ows_now(), &v, text, sizeof(text)));
	TEST_ASSERT_EQUAL_STRING("20", text);
	TEST_ASSERT_EQUAL(-ESTALE, ows_get_text(h, label, ows_now(), &v, text, sizeof(text)));
	TEST_ASSERT_EQUAL(-ESTALE, ows_get(h, age, ows_now(), &v));
	TEST_ASSERT_EQUAL(-ESTALE, ows_daemon(h, ows_now(), &daemon));
	TEST_ASSERT_FALSE(daemon.alive);
	TEST_ASSERT_EQUAL(-ESTALE, ows_alarm_state(h, room, &state));
	TEST_ASSERT_EQUAL(-ESTALE, ows_command(h, room, &command));
	TEST_ASSERT_EQUAL(0, reopen());
	TEST_ASSERT_EQUAL(0, ows_get(h, age, ows_now(), &v));
	TEST_ASSERT_EQUAL(0, ows_daemon(h, ows_now(), &daemon));
	TEST_ASSERT_TRUE(daemon.alive);
	TEST_ASSERT_EQUAL(0, ows_alarm_state(h, room, &state));
	TEST_ASSERT_EQUAL(0, ows_command(h, room, &command));
}

static void test_what_is_set_in_an_orphan_is_said_to_be_lost(void)
{
	const int ids[] = {relay, relay};
	const double values[] = {1, 0};

	kill_first(DEAD);
	replace();
	TEST_ASSERT_EQUAL(-ESTALE, ows_set(h, relay, 1, NULL));
	TEST_ASSERT_EQUAL(-ESTALE, ows_set_text(h, label, "x", NULL));
	TEST_ASSERT_EQUAL(-ESTALE, ows_set_many(h, ids, values, 2));
	TEST_ASSERT_EQUAL(-ESTALE, ows_acknowledge(h, room));
	TEST_ASSERT_EQUAL(-ESTALE, ows_beat(h, 1000));
	TEST_ASSERT_EQUAL(0, reopen());
	TEST_ASSERT_EQUAL(0, ows_beat(h, 1000));
	TEST_ASSERT_EQUAL(0, ows_set(h, relay, 1, NULL));
	TEST_ASSERT_EQUAL_INT64(1, instance_command(&second, 0, RELAY).value);
}

static void test_a_look_leaves_errno_alone(void)
{
	remove_names();
	errno = EDOM;
	TEST_ASSERT_EQUAL(0, get(t0 + DEAD));
	TEST_ASSERT_EQUAL(EDOM, errno);
}

static void test_who_waits_on_an_orphan_is_told(void)
{
	uint32_t news = 0;

	TEST_ASSERT_EQUAL(1, ows_wait(h, &news, 0));
	kill_first(DEAD);
	TEST_ASSERT_EQUAL(1, ows_wait(h, &news, 0));
	replace();
	TEST_ASSERT_EQUAL(-ESTALE, ows_wait(h, &news, 60 * INSTANCE_S));
	TEST_ASSERT_EQUAL(-ESTALE, ows_wait(h, &news, -1));
	TEST_ASSERT_EQUAL(-ESTALE, ows_wait(h, &news, 0));
}

static void test_who_waits_on_an_owsd_that_was_stopped_and_goes_on_is_served(void)
{
	const struct timespec pause = {.tv_nsec = 50000000};
	int64_t deadline = ows_now() + 20 * INSTANCE_S;
	uint32_t news = 0;
	int got;

	kill_first(DEAD);
	replace();
	TEST_ASSERT_EQUAL(-ESTALE, ows_wait(h, &news, 0));
	do {
		instance_beat(&first, ows_now(), 1);
		got = ows_wait(h, &news, 0);
		nanosleep(&pause, NULL); /* pace */
	} while (got == -ESTALE && ows_now() < deadline);
	TEST_ASSERT_EQUAL(1, got);
}

static void test_who_waits_on_a_dead_owsd_wakes_at_his_time(void)
{
	uint32_t news = 0;

	kill_first(DEAD);
	TEST_ASSERT_EQUAL(1, ows_wait(h, &news, 0));
	remove_names();
	TEST_ASSERT_EQUAL(0, ows_wait(h, &news, 1000000));
	TEST_ASSERT_EQUAL(0,
	                  ows_wait(h, &news, INSTANCE_S + 1000000)); /* longer than between looks */
}

static void *replace_later(void *arg)
{
	(void)arg;
	until_asleep(NULL);
	start_second();
	return NULL;
}

/* Nobody wakes it: nobody has what it sleeps on. */
static void test_a_sleeper_on_an_orphan_wakes_by_itself(void)
{
	uint32_t news = 0;
	pthread_t thread;

	kill_first(DEAD);
	remove_names();
	TEST_ASSERT_EQUAL(1, ows_wait(h, &news, 0));
	TEST_ASSERT_EQUAL(0, pthread_create(&thread, NULL, replace_later, NULL));
	TEST_ASSERT_EQUAL(-ESTALE, ows_wait(h, &news, 60 * INSTANCE_S));
	pthread_join(thread, NULL);
	TEST_ASSERT_EQUAL(0, reopen());
	TEST_ASSERT_EQUAL(0, get(ows_now()));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_reader_of_an_orphan_is_led_to_the_next_owsd);
	RUN_TEST(test_while_the_heart_beats_nobody_looks_at_names);
	RUN_TEST(test_a_name_that_leads_nowhere_yet_is_no_reason_to_reopen);
	RUN_TEST(test_a_dead_owsd_whose_names_are_in_place_is_no_orphan);
	RUN_TEST(test_names_are_looked_at_once_a_second);
	RUN_TEST(test_every_way_to_look_at_an_orphan_says_so);
	RUN_TEST(test_what_is_set_in_an_orphan_is_said_to_be_lost);
	RUN_TEST(test_a_look_leaves_errno_alone);
	RUN_TEST(test_who_waits_on_an_orphan_is_told);
	RUN_TEST(test_who_waits_on_an_owsd_that_was_stopped_and_goes_on_is_served);
	RUN_TEST(test_who_waits_on_a_dead_owsd_wakes_at_his_time);
	RUN_TEST(test_a_sleeper_on_an_orphan_wakes_by_itself);
	return UNITY_END();
}
