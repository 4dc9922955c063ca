/* SPDX-License-Identifier: MIT */
/* Who gave the command in force, and the journal of commands. */
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
	scene_output(&s, "out", PIO, OWS_BYTE);
	scene_output(&s, "begun", PIO2, OWS_BYTE);
	s.items[1].has_init = s.items[1].has_safe = true;
	s.items[1].init_value = 3;
	s.items[1].safe_value = 4;
	scene_output(&s, "text", ALIAS, OWS_STRING);
	scene_put(&s, PIO, "0", 0);
	scene_put(&s, PIO2, "0", 0);
	scene_put(&s, ALIAS, "", 0);
	scene_start(&s);
	scene_up(&s);
	scene_run(&s, SCENE_S);
}

void tearDown(void)
{
	scene_end(&s);
}

static uint32_t entered(void)
{
	return s.image.header->command_head;
}

/* The entry of that number, counted from the newest. */
static const struct ows_journal_entry *entry(unsigned back)
{
	return &s.image.commands[(entered() - 1 - back) % OWS_JOURNAL];
}

static void set(unsigned seat, unsigned record, int64_t value)
{
	scene_set_by(&s, seat, record, value);
	scene_run(&s, 100 * SCENE_MS);
}

static void test_an_output_that_nobody_commanded_has_no_origin(void)
{
	TEST_ASSERT_EQUAL_UINT(OWS_REASON_NONE, scene_origin(&s, 1).reason);
	TEST_ASSERT_EQUAL_INT64(0, scene_origin(&s, 1).taken_ns);
}

static void test_initvalue_is_owsd_s_own(void)
{
	TEST_ASSERT_EQUAL_UINT(OWS_REASON_INIT, scene_origin(&s, 2).reason);
	TEST_ASSERT_EQUAL_UINT32(0, scene_origin(&s, 2).who.serial);
	TEST_ASSERT_EQUAL_UINT32(1, entered());
	TEST_ASSERT_EQUAL_UINT(OWS_REASON_INIT, entry(0)->kind);
	TEST_ASSERT_EQUAL_UINT32(2, entry(0)->record);
	TEST_ASSERT_EQUAL_INT64(3, entry(0)->after);
}

static void test_a_command_has_its_controller_and_its_time(void)
{
	int64_t now_ns = s.now_ns;

	set(0, 1, 5);
	TEST_ASSERT_EQUAL_UINT(OWS_REASON_SET, scene_origin(&s, 1).reason);
	TEST_ASSERT_EQUAL_STRING("controller0", scene_origin(&s, 1).who.name);
	TEST_ASSERT_EQUAL_UINT32(1000, scene_origin(&s, 1).who.uid);
	TEST_ASSERT_EQUAL_INT32(100, scene_origin(&s, 1).who.pid);
	TEST_ASSERT_EQUAL_INT64(now_ns, scene_origin(&s, 1).taken_ns);
}

static void test_a_command_for_a_person_has_that_person(void)
{
	giving_name_person(&s.controllers[0], 2, "anna");
	scene_slot(&s, 1)->person = 3;
	set(0, 1, 5);
	TEST_ASSERT_EQUAL_STRING("anna", scene_origin(&s, 1).who.person);
	TEST_ASSERT_EQUAL_STRING("anna", entry(0)->who.person);
	scene_slot(&s, 1)->person = 0;
	set(0, 1, 6);
	TEST_ASSERT_EQUAL_STRING("", scene_origin(&s, 1).who.person);
	scene_slot(&s, 1)->person = 4711; /* rubbish */
	set(0, 1, 7);
	TEST_ASSERT_EQUAL_STRING("", scene_origin(&s, 1).who.person);
}

static void test_another_person_of_the_same_controller_is_an_entry_at_once(void)
{
	uint32_t before;

	giving_name_person(&s.controllers[0], 0, "anna");
	giving_name_person(&s.controllers[0], 1, "berta");
	scene_slot(&s, 1)->person = 1;
	set(0, 1, 5);
	set(0, 1, 6);
	before = entered();
	scene_slot(&s, 1)->person = 2;
	set(0, 1, 7);
	TEST_ASSERT_EQUAL_UINT32(before + 2, entered());
	TEST_ASSERT_EQUAL_STRING("anna", entry(1)->who.person);
	TEST_ASSERT_EQUAL_INT64(6, entry(1)->after);
	TEST_ASSERT_EQUAL_STRING("berta", entry(0)->who.person);
	TEST_ASSERT_EQUAL_INT64(7, entry(0)->after);
}

static void test_the_journal_has_the_values_before_and_after(void)
{
	uint32_t before = entered();

	set(0, 1, 5);
	TEST_ASSERT_EQUAL_UINT32(before + 1, entered());
	TEST_ASSERT_EQUAL_HEX8(OWS_JOURNAL_AFTER, entry(0)->flags);
	scene_run(&s, SCENE_S);
	set(0, 1, 6);
	TEST_ASSERT_EQUAL_HEX8(OWS_JOURNAL_AFTER | OWS_JOURNAL_BEFORE, entry(0)->flags);
	TEST_ASSERT_EQUAL_INT64(5, entry(0)->before);
	TEST_ASSERT_EQUAL_INT64(6, entry(0)->after);
	scene_set_text(&s, 3, "boiler");
	scene_run(&s, 100 * SCENE_MS);
	TEST_ASSERT_EQUAL_STRING("boiler", entry(0)->text);
}

static void test_the_same_value_again_is_no_entry(void)
{
	uint32_t before;

	set(0, 1, 5);
	before = entered();
	for (int i = 0; i < 50; i++)
		set(0, 1, 5);
	TEST_ASSERT_EQUAL_UINT32(before, entered());
}

static void test_a_controller_that_commands_without_end_has_an_entry_a_second(void)
{
	uint32_t before = entered();

	for (int i = 0; i < 100; i++)
		set(0, 1, i & 255);
	TEST_ASSERT_UINT_WITHIN(1, 10, entered() - before);
	TEST_ASSERT_UINT_WITHIN(1, 9, entry(0)->more);
	TEST_ASSERT_EQUAL_UINT32(0, entry(entered() - before - 1)->more);
}

static void test_the_last_command_of_a_second_is_entered_when_the_second_is_over(void)
{
	uint32_t before;
	int64_t last_ns;

	set(0, 1, 5);
	set(0, 1, 6);
	before = entered();
	last_ns = s.now_ns;
	set(0, 1, 0);
	TEST_ASSERT_EQUAL_UINT32(before, entered());
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT32(before + 1, entered());
	TEST_ASSERT_EQUAL_HEX8(OWS_JOURNAL_AFTER, entry(0)->flags);
	TEST_ASSERT_EQUAL_INT64(0, entry(0)->after);
	TEST_ASSERT_EQUAL_INT64(last_ns, entry(0)->occurred_ns);
	TEST_ASSERT_EQUAL_UINT32(1, entry(0)->more);
	TEST_ASSERT_EQUAL_STRING("controller0", entry(0)->who.name);
	scene_run(&s, 60 * SCENE_S);
	TEST_ASSERT_EQUAL_UINT32(before + 1, entered());
}

static void test_so_is_the_last_text_and_the_last_of_those_who_fight_over_a_reload_too(void)
{
	uint32_t before;

	scene_set_text(&s, 3, "boiler");
	scene_run(&s, 100 * SCENE_MS);
	scene_set_text(&s, 3, "pump");
	scene_run(&s, 100 * SCENE_MS);
	scene_join(&s, 1, 2);
	for (int i = 0; i < 31; i++)
		set(i & 1, 1, i);
	before = entered();
	scene_reload(&s, NULL);
	scene_run(&s, 10 * SCENE_S);
	TEST_ASSERT_EQUAL_UINT32(before + 1, entered());
	TEST_ASSERT_EQUAL_INT64(30, entry(0)->after);
	TEST_ASSERT_EQUAL_STRING("controller0", entry(0)->who.name);
	for (uint32_t i = 0; i < entered(); i++)
		before -= entry(i)->record == 3 && !strcmp(entry(i)->text, "pump");
	TEST_ASSERT_EQUAL_UINT32(entered() - 2, before);
}

static void test_another_controller_is_an_entry_at_once_and_what_was_before_it_is_not_lost(void)
{
	uint32_t before;

	scene_join(&s, 1, 2);
	set(0, 1, 5);
	set(0, 1, 6);
	set(0, 1, 7);
	before = entered();
	set(1, 1, 8);
	TEST_ASSERT_EQUAL_UINT32(before + 2, entered());
	TEST_ASSERT_EQUAL_STRING("controller0", entry(1)->who.name);
	TEST_ASSERT_EQUAL_INT64(7, entry(1)->after);
	TEST_ASSERT_EQUAL_UINT32(1, entry(1)->more);
	TEST_ASSERT_EQUAL_STRING("controller1", entry(0)->who.name);
	TEST_ASSERT_EQUAL_INT64(8, entry(0)->after);
	TEST_ASSERT_EQUAL_UINT32(0, entry(0)->more);
}

static void test_controllers_that_fight_over_an_output_do_not_flush_the_journal(void)
{
	uint32_t before = entered(), all = 0;

	scene_join(&s, 1, 2);
	for (int i = 0; i < 200; i++)
		set(i & 1, 1, i & 1);
	/* 20 seconds: at once, then one a second, each with the one that it took the place of */
	TEST_ASSERT_GREATER_THAN_UINT32(before + 20, entered());
	TEST_ASSERT_LESS_THAN_UINT32(before + 2 * (8 + 21), entered());
	for (uint32_t i = 0; i < entered() - before; i++)
		all += 1 + entry(i)->more;
	TEST_ASSERT_UINT_WITHIN(20, 200, all);
	scene_join(&s, 2, 3);
	set(2, 2, 7);
	TEST_ASSERT_EQUAL_UINT32(2, entry(0)->record);
}

static void test_safevalue_names_the_controller_that_is_lost(void)
{
	giving_beat(&s.controllers[0], 500);
	set(0, 2, 9);
	scene_run(&s, 5 * SCENE_S);
	TEST_ASSERT_EQUAL_UINT(OWS_REASON_SAFE, scene_origin(&s, 2).reason);
	TEST_ASSERT_EQUAL_STRING("controller0", scene_origin(&s, 2).who.name);
	TEST_ASSERT_EQUAL_UINT(OWS_REASON_SAFE, entry(0)->kind);
	TEST_ASSERT_EQUAL_INT64(4, entry(0)->after);
	TEST_ASSERT_EQUAL_INT64(9, entry(0)->before);
}

static void test_origins_and_journal_go_on_over_a_reload(void)
{
	uint32_t before;

	set(0, 1, 5);
	before = entered();
	scene_reload(&s, NULL);
	TEST_ASSERT_EQUAL_UINT(OWS_REASON_SET, scene_origin(&s, 1).reason);
	TEST_ASSERT_EQUAL_STRING("controller0", scene_origin(&s, 1).who.name);
	TEST_ASSERT_EQUAL_UINT(OWS_REASON_INIT, scene_origin(&s, 2).reason);
	TEST_ASSERT_EQUAL_UINT32(before, entered());
	set(0, 1, 5);
	TEST_ASSERT_EQUAL_UINT32(before, entered());
}

/* The entry 0 is of "begun", which goes; "out" gets an InitValue, but not in force. */
static void replace_begun(struct config *config)
{
	config->items[0].has_init = true;
	config->items[0].init_value = 7;
	config->items[1] = config->items[2];
	config->item_count = 2;
}

static void test_over_a_reload_the_journal_gets_no_command_that_was_not_in_force(void)
{
	TEST_ASSERT_EQUAL_UINT32(1, entered());
	scene_reload(&s, replace_begun);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT(OWS_REASON_NONE, scene_origin(&s, 1).reason);
	TEST_ASSERT_EQUAL_UINT32(1, entered());
	TEST_ASSERT_EQUAL_UINT32(0, entry(0)->record);
}

static void test_a_refused_command_changes_neither(void)
{
	uint32_t before;

	set(0, 1, 5);
	before = entered();
	set(0, 1, 999);
	TEST_ASSERT_EQUAL_UINT32(before, entered());
	TEST_ASSERT_EQUAL_UINT32(1, s.image.controllers[0].refused);
	TEST_ASSERT_EQUAL_UINT32(1, s.image.controllers[0].commands);
}

static void test_the_image_shows_who_is_connected(void)
{
	const struct ows_controller_entry *g = &s.image.controllers[2];

	TEST_ASSERT_EQUAL_HEX32(0, g->flags);
	scene_allow(&s, 2, 1);
	scene_join(&s, 2, 5);
	TEST_ASSERT_EQUAL_HEX32(OWS_CONTROLLER_CONNECTED | OWS_CONTROLLER_MAY_SET, g->flags);
	TEST_ASSERT_EQUAL_STRING("controller2", g->who.name);
	giving_beat(&s.controllers[2], 500);
	scene_run(&s, 200 * SCENE_MS);
	TEST_ASSERT_EQUAL_UINT32(500, g->period_ms);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_BITS_HIGH(OWS_CONTROLLER_LATE, g->flags);
	giving_beat(&s.controllers[2], 500);
	scene_run(&s, 200 * SCENE_MS);
	TEST_ASSERT_BITS_LOW(OWS_CONTROLLER_LATE, g->flags);
	scene_leave(&s, 2);
	TEST_ASSERT_EQUAL_HEX32(0, g->flags);
	memset(s.rights[2], 0, sizeof(s.rights[2]));
	scene_join(&s, 2, 5);
	TEST_ASSERT_EQUAL_HEX32(OWS_CONTROLLER_CONNECTED, g->flags);
}

static void a_new_output(struct config *config)
{
	config->items[config->item_count] = config->items[1];
	config->items[config->item_count].name = "new";
	config->items[config->item_count++].path = "/29.000000000004/PIO.BYTE";
}

static void test_what_a_reload_begins_with_has_an_entry_and_the_time_of_the_reload(void)
{
	int64_t set_ns, begun_ns = scene_origin(&s, 2).taken_ns;
	uint32_t before;

	set(0, 1, 5);
	set_ns = scene_origin(&s, 1).taken_ns;
	before = entered();
	scene_run(&s, 60 * SCENE_S);
	scene_reload(&s, a_new_output);
	TEST_ASSERT_EQUAL_UINT32(before + 1, entered());
	TEST_ASSERT_EQUAL_UINT32(4, entry(0)->record);
	TEST_ASSERT_EQUAL_UINT(OWS_REASON_INIT, entry(0)->kind);
	TEST_ASSERT_EQUAL_INT64(s.now_ns, entry(0)->occurred_ns);
	TEST_ASSERT_EQUAL_INT64(3, entry(0)->after);
	TEST_ASSERT_EQUAL_UINT(0, entry(0)->flags & OWS_JOURNAL_BEFORE);
	TEST_ASSERT_EQUAL_UINT(OWS_REASON_INIT, scene_origin(&s, 4).reason);
	TEST_ASSERT_EQUAL_INT64(s.now_ns, scene_origin(&s, 4).taken_ns);
	/* what goes on has neither */
	TEST_ASSERT_EQUAL_INT64(set_ns, scene_origin(&s, 1).taken_ns);
	TEST_ASSERT_EQUAL_INT64(begun_ns, scene_origin(&s, 2).taken_ns);
	scene_reload(&s, NULL);
	TEST_ASSERT_EQUAL_UINT32(before + 1, entered());
}

static void begun_is_an_input(struct config *config)
{
	config->items[1].output = config->items[1].has_init = false;
	config->items[1].readable = true;
}

static void begun_is_an_output(struct config *config)
{
	config->items[1].output = config->items[1].has_init = true;
}

static void test_an_input_that_becomes_an_output_has_an_entry_of_its_initvalue(void)
{
	uint32_t before;

	scene_reload(&s, begun_is_an_input);
	TEST_ASSERT_EQUAL_UINT(OWS_REASON_NONE, scene_origin(&s, 2).reason);
	before = entered();
	scene_run(&s, 60 * SCENE_S);
	scene_reload(&s, begun_is_an_output);
	TEST_ASSERT_EQUAL_UINT32(before + 1, entered());
	TEST_ASSERT_EQUAL_UINT32(2, entry(0)->record);
	TEST_ASSERT_EQUAL_UINT(OWS_REASON_INIT, entry(0)->kind);
	TEST_ASSERT_EQUAL_INT64(s.now_ns, scene_origin(&s, 2).taken_ns);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_an_output_that_nobody_commanded_has_no_origin);
	RUN_TEST(test_initvalue_is_owsd_s_own);
	RUN_TEST(test_a_command_has_its_controller_and_its_time);
	RUN_TEST(test_a_command_for_a_person_has_that_person);
	RUN_TEST(test_another_person_of_the_same_controller_is_an_entry_at_once);
	RUN_TEST(test_the_journal_has_the_values_before_and_after);
	RUN_TEST(test_the_same_value_again_is_no_entry);
	RUN_TEST(test_a_controller_that_commands_without_end_has_an_entry_a_second);
	RUN_TEST(test_the_last_command_of_a_second_is_entered_when_the_second_is_over);
	RUN_TEST(test_so_is_the_last_text_and_the_last_of_those_who_fight_over_a_reload_too);
	RUN_TEST(test_another_controller_is_an_entry_at_once_and_what_was_before_it_is_not_lost);
	RUN_TEST(test_controllers_that_fight_over_an_output_do_not_flush_the_journal);
	RUN_TEST(test_safevalue_names_the_controller_that_is_lost);
	RUN_TEST(test_origins_and_journal_go_on_over_a_reload);
	RUN_TEST(test_over_a_reload_the_journal_gets_no_command_that_was_not_in_force);
	RUN_TEST(test_a_refused_command_changes_neither);
	RUN_TEST(test_the_image_shows_who_is_connected);
	RUN_TEST(test_what_a_reload_begins_with_has_an_entry_and_the_time_of_the_reload);
	RUN_TEST(test_an_input_that_becomes_an_output_has_an_entry_of_its_initvalue);
	return UNITY_END();
}
