/* SPDX-License-Identifier: MIT */
/*
 * Outputs with Start "last": a command is applied when it is on the disk too, and a disk that fails
 * is seen.
 */
#include <errno.h>
#include <string.h>

#include "unity.h"

#include "tests/unit/aid/scene.h"

#define PIO "/29.000000000001/PIO.BYTE"
#define PIO2 "/29.000000000002/PIO.BYTE"
#define ALIAS "/28.000000000003/alias"

static struct scene s;

void setUp(void)
{
	scene_init(&s);
}

void tearDown(void)
{
	scene_end(&s);
}

/* Record 1 begins as it was last, record 2 does not; record 3 is a string that does. */
static void start(void)
{
	scene_output(&s, "last", PIO, OWS_BYTE)->starts_last = true;
	scene_output(&s, "init", PIO2, OWS_BYTE);
	scene_output(&s, "text", ALIAS, OWS_STRING)->starts_last = true;
	scene_put(&s, PIO, "0", 0);
	scene_put(&s, PIO2, "0", 0);
	scene_put(&s, ALIAS, "", 0);
	scene_start(&s);
	scene_up(&s);
	scene_run(&s, SCENE_S);
}

static void test_a_command_is_applied_when_it_is_written_and_stored(void)
{
	start();
	s.disk.waits = true;
	scene_set(&s, 1, 7);
	scene_set(&s, 2, 8);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_STRING("7", scene_at(&s, PIO)); /* the output does not wait */
	TEST_ASSERT_EQUAL_UINT32(0, scene_applied(&s, 1));
	TEST_ASSERT_EQUAL_UINT32(2, scene_applied(&s, 2));
	scene_store(&s);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT32(1, scene_applied(&s, 1));
}

static void test_a_command_that_is_stored_first_is_applied_when_it_is_written(void)
{
	start();
	scene_down(&s, -ECONNRESET);
	scene_set(&s, 1, 7);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT32(s.disk.tickets, s.disk.stored);
	TEST_ASSERT_EQUAL_UINT32(0, scene_applied(&s, 1));
	scene_up(&s);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT32(1, scene_applied(&s, 1));
}

static void test_only_the_newest_of_several_commands_is_waited_for(void)
{
	start();
	s.disk.waits = true;
	for (int i = 1; i <= 5; i++) {
		scene_set(&s, 1, i);
		scene_run(&s, 200 * SCENE_MS);
	}
	TEST_ASSERT_EQUAL_UINT32(0, scene_applied(&s, 1));
	scene_store(&s);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT32(5, scene_applied(&s, 1));
	TEST_ASSERT_EQUAL_INT64(5, s.disk.rows[0].value);
}

static void test_a_full_disk_is_seen_and_a_command_on_it_is_not_applied(void)
{
	start();
	s.disk.full = true;
	scene_set(&s, 1, 7);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_STRING("7", scene_at(&s, PIO));
	TEST_ASSERT_EQUAL_UINT32(0, scene_applied(&s, 1));
	TEST_ASSERT_EQUAL_INT32(-ENOSPC, scene_sample(&s, 1).err);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_GOOD, scene_sample(&s, 1).quality);
	s.disk.full = false;
	scene_store(&s);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT32(1, scene_applied(&s, 1));
	TEST_ASSERT_EQUAL_INT32(0, scene_sample(&s, 1).err);
}

static void test_a_reload_goes_on_waiting_for_the_disk(void)
{
	start();
	s.disk.waits = true;
	scene_set(&s, 1, 7);
	scene_run(&s, SCENE_S);
	scene_reload(&s, NULL);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT32(0, scene_applied(&s, 1));
	scene_store(&s);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT32(1, scene_applied(&s, 1));
}

static void new_name(struct config *config)
{
	config->items[0].name = "renamed";
}

static void test_the_command_of_a_renamed_output_is_stored_by_its_new_name(void)
{
	start();
	scene_set(&s, 1, 7);
	scene_run(&s, SCENE_S);
	s.disk.rows[0].known = false; /* nothing is stored by that name */
	scene_clear_trace(&s);
	scene_reload(&s, new_name);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT(0, s.writes);
	TEST_ASSERT_TRUE(s.disk.rows[0].known);
	TEST_ASSERT_EQUAL_INT64(7, s.disk.rows[0].value);
}

static void test_a_text_begins_as_it_was_last(void)
{
	start();
	scene_set_text(&s, 3, "boiler");
	scene_run(&s, SCENE_S);
	scene_reboot(&s);
	scene_up(&s);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_STRING("W " ALIAS "=boiler\n", s.trace);
	TEST_ASSERT_EQUAL_UINT(OWS_REASON_LAST, scene_origin(&s, 3).reason);
}

static void test_what_was_stored_last_is_written_once_after_a_start(void)
{
	start();
	scene_set(&s, 1, 7);
	scene_run(&s, SCENE_S);
	for (int i = 0; i < 3; i++) {
		scene_reboot(&s);
		scene_up(&s);
		scene_run(&s, 10 * SCENE_S);
		TEST_ASSERT_EQUAL_STRING("W " PIO "=7\n", s.trace);
	}
}

static void test_what_the_owsd_before_could_not_store_is_stored_by_the_next(void)
{
	start();
	s.disk.full = true;
	scene_set(&s, 1, 7);
	scene_run(&s, SCENE_S);
	s.disk.full = false; /* owsd is killed before it tries again */
	scene_restart(&s);
	scene_up(&s);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_STRING("7", scene_at(&s, PIO));
	scene_put(&s, PIO, "0", 0);
	scene_reboot(&s);
	scene_up(&s);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_STRING("7", scene_at(&s, PIO));
}

static void test_what_was_stored_and_is_beyond_max_now_gives_way_to_initvalue(void)
{
	start();
	scene_set(&s, 1, 70);
	scene_run(&s, SCENE_S);
	s.items[0].has_init = true;
	s.items[0].init_value = 5;
	s.items[0].scale.has_max = true;
	s.items[0].scale.max = 50;
	scene_reboot(&s);
	scene_up(&s);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_STRING("5", scene_at(&s, PIO));
	TEST_ASSERT_EQUAL_UINT(OWS_REASON_INIT, scene_origin(&s, 1).reason);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_command_is_applied_when_it_is_written_and_stored);
	RUN_TEST(test_a_command_that_is_stored_first_is_applied_when_it_is_written);
	RUN_TEST(test_only_the_newest_of_several_commands_is_waited_for);
	RUN_TEST(test_a_full_disk_is_seen_and_a_command_on_it_is_not_applied);
	RUN_TEST(test_a_reload_goes_on_waiting_for_the_disk);
	RUN_TEST(test_the_command_of_a_renamed_output_is_stored_by_its_new_name);
	RUN_TEST(test_a_text_begins_as_it_was_last);
	RUN_TEST(test_what_was_stored_last_is_written_once_after_a_start);
	RUN_TEST(test_what_the_owsd_before_could_not_store_is_stored_by_the_next);
	RUN_TEST(test_what_was_stored_and_is_beyond_max_now_gives_way_to_initvalue);
	return UNITY_END();
}
