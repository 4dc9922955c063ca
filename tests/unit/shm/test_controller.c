/* SPDX-License-Identifier: MIT */
/* The memory of a controller as owsd reads it: orders and edges, texts, and anything that is
 * wrong. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "unity.h"

#include "src/public/ows.h"
#include "tests/unit/aid/giving.h"

#define NUMBER 1
#define STRING 2
#define SIGNALS 40

static struct controller_layout layout, next_layout;
static struct giving controller, next;
static char text[1024 + 1];

void setUp(void)
{
	uint8_t types[SIGNALS] = {OWS_LARGE, OWS_STRING, OWS_BOOL, OWS_STRING};

	giving_layout(&layout, types, SIGNALS);
	giving_layout(&next_layout, types, SIGNALS);
	controller = next = (struct giving){0};
	giving_make(&controller, &layout, 7);
	giving_make(&next, &next_layout, 7);
}

void tearDown(void)
{
	giving_free(&controller);
	giving_free(&next);
	controller_layout_free(&layout);
	controller_layout_free(&next_layout);
}

static struct controller_command load(uint32_t record)
{
	struct controller_command command;

	controller_load(&controller.memory, record, &command);
	return command;
}

static void test_the_areas_of_a_memory_lie_apart_and_inside(void)
{
	const uint32_t area[][2] = {
		{0, sizeof(struct ows_controller_header)},
		{layout.header.slot_off, (SIGNALS + 1) * sizeof(struct ows_command_slot)},
		{layout.header.dirty_off, 4 * layout.header.dirty_words},
		{layout.header.place_off, 4 * (SIGNALS + 1)},
		{layout.header.person_off, OWS_PERSONS * OWS_NAME},
		{layout.header.shelf_off, sizeof(struct ows_command_shelf)},
		{layout.header.text_off,
	         2 * (sizeof(struct ows_command_text) + layout.header.text_cap)},
	};

	for (size_t i = 0; i < sizeof(area) / sizeof(area[0]); i++) {
		TEST_ASSERT_EQUAL_UINT32(0, area[i][0] % 8);
		TEST_ASSERT_TRUE(area[i][0] + area[i][1] <= layout.header.size);
		if (i)
			TEST_ASSERT_TRUE(area[i][0] >= area[i - 1][0] + area[i - 1][1]);
	}
	TEST_ASSERT_TRUE(layout.header.dirty_words * 32 > SIGNALS);
	TEST_ASSERT_EQUAL_UINT32(CONTROLLER_NO_TEXT, layout.places[0]);
	TEST_ASSERT_EQUAL_UINT32(CONTROLLER_NO_TEXT, layout.places[NUMBER]);
	TEST_ASSERT_EQUAL_UINT32(0, layout.places[STRING]);
	TEST_ASSERT_EQUAL_UINT32(1, layout.places[4]);
}

static void test_a_layout_that_no_offset_reaches_is_refused(void)
{
	struct controller_layout large;
	uint8_t *types = malloc(65535);

	TEST_ASSERT_NOT_NULL(types);
	memset(types, OWS_STRING, 65535);
	TEST_ASSERT_EQUAL(-EFBIG, controller_layout_make(
					  &large, &(struct controller_plan){.types = types,
	                                                                    .signal_count = 65535,
	                                                                    .text_cap = 65532}));
	free(types);
}

static void test_a_command_is_fresh_until_it_was_taken(void)
{
	TEST_ASSERT_FALSE(load(NUMBER).fresh);
	giving_set(&controller, NUMBER, -5);
	TEST_ASSERT_TRUE(load(NUMBER).fresh);
	TEST_ASSERT_EQUAL_INT64(-5, load(NUMBER).value);
	TEST_ASSERT_EQUAL_UINT32(1, load(NUMBER).stamp);
	controller_taken(&controller.memory, NUMBER, 1, -ERANGE);
	TEST_ASSERT_FALSE(load(NUMBER).fresh);
	TEST_ASSERT_EQUAL_INT(-ERANGE, giving_slot(&controller, NUMBER)->err);
	giving_set(&controller, NUMBER, -5);
	TEST_ASSERT_TRUE(load(NUMBER).fresh);
}

static void test_each_edge_counts_once(void)
{
	struct ows_command_slot *slot = giving_slot(&controller, NUMBER);
	struct controller_command c;

	giving_enable(&slot->read_enable, false);
	giving_enable(&slot->write_enable, true);
	slot->one_shot++;
	slot->dgn_reset += OWS_STEP_READ + 1;
	slot->acknowledged++;
	c = load(NUMBER);
	TEST_ASSERT_EQUAL_UINT8(1, c.read_enable);
	TEST_ASSERT_EQUAL_UINT8(2, c.write_enable);
	TEST_ASSERT_TRUE(c.one_shot && c.dgn_reset && c.acknowledged && c.read_once);
	c = load(NUMBER);
	TEST_ASSERT_EQUAL_UINT8(0, c.read_enable);
	TEST_ASSERT_EQUAL_UINT8(0, c.write_enable);
	TEST_ASSERT_FALSE(c.one_shot || c.dgn_reset || c.acknowledged || c.read_once);
	/* two counters are halves of one word */
	slot->dgn_reset += OWS_STEP_READ;
	c = load(NUMBER);
	TEST_ASSERT_TRUE(c.read_once && !c.dgn_reset && !c.acknowledged);
	slot->dgn_reset++;
	c = load(NUMBER);
	TEST_ASSERT_TRUE(c.dgn_reset && !c.read_once && !c.acknowledged);
	slot->acknowledged++;
	c = load(NUMBER);
	TEST_ASSERT_TRUE(c.acknowledged && !c.read_once && !c.dgn_reset);
	/* the same order once more is a new one */
	giving_enable(&slot->read_enable, false);
	TEST_ASSERT_EQUAL_UINT8(1, load(NUMBER).read_enable);
}

static void test_numbers_out_of_their_range_count_as_nothing(void)
{
	struct ows_command_slot *slot = giving_slot(&controller, NUMBER);

	slot->person = OWS_PERSONS + 1;
	slot->read_enable = UINT32_MAX;
	slot->write_enable = 7;
	TEST_ASSERT_EQUAL_UINT32(0, load(NUMBER).person);
	slot->person = UINT32_MAX;
	TEST_ASSERT_EQUAL_UINT32(0, load(NUMBER).person);
	slot->person = OWS_PERSONS;
	TEST_ASSERT_EQUAL_UINT32(OWS_PERSONS, load(NUMBER).person);
	TEST_ASSERT_EQUAL_UINT8(0, load(NUMBER).read_enable);
}

static void test_marks_are_found_in_order_and_once(void)
{
	giving_mark(&controller, 33);
	giving_mark(&controller, 0);
	giving_mark(&controller, SIGNALS);
	TEST_ASSERT_TRUE(controller_is_marked(&controller.memory));
	TEST_ASSERT_TRUE(controller_marked(&controller.memory));
	TEST_ASSERT_FALSE(controller_marked(&controller.memory));
	TEST_ASSERT_EQUAL_INT(0, controller_next_dirty(&controller.memory, 0));
	TEST_ASSERT_EQUAL_INT(33, controller_next_dirty(&controller.memory, 0));
	TEST_ASSERT_EQUAL_INT(SIGNALS, controller_next_dirty(&controller.memory, 34));
	TEST_ASSERT_EQUAL_INT(-1, controller_next_dirty(&controller.memory, 0));
}

static void test_marks_of_slots_that_do_not_exist_are_nothing(void)
{
	uint32_t *dirty = (void *)(controller.memory.base + layout.header.dirty_off);

	dirty[1] = 0xffffffffu << (SIGNALS + 1) % 32;
	TEST_ASSERT_EQUAL_INT(-1, controller_next_dirty(&controller.memory, 0));
}

static void test_a_text_with_a_wrong_length_or_check_is_refused(void)
{
	giving_set_text(&controller, STRING, "boiler");
	TEST_ASSERT_EQUAL_INT(6, controller_text(&controller.memory, STRING, text));
	TEST_ASSERT_EQUAL_STRING("boiler", text);
	giving_text(&controller, STRING)->len = 5;
	TEST_ASSERT_EQUAL_INT(-EBADMSG, controller_text(&controller.memory, STRING, text));
	giving_text(&controller, STRING)->len = layout.header.text_cap + 1;
	TEST_ASSERT_EQUAL_INT(-EBADMSG, controller_text(&controller.memory, STRING, text));
	giving_text(&controller, STRING)->len = UINT32_MAX;
	TEST_ASSERT_EQUAL_INT(-EBADMSG, controller_text(&controller.memory, STRING, text));
}

static void test_names_are_cut_and_without_control_characters_and_quotes(void)
{
	char name[OWS_NAME];

	giving_name_person(&controller, 2, "anna\"\n\033[2J");
	controller_person(&controller.memory, 3, name);
	TEST_ASSERT_EQUAL_STRING("anna'??[2J", name);
	memset(controller.memory.base + layout.header.person_off, 'x', OWS_NAME);
	controller_person(&controller.memory, 1, name);
	TEST_ASSERT_EQUAL_UINT(OWS_NAME - 1, strlen(name));
	controller_person(&controller.memory, 0, name);
	TEST_ASSERT_EQUAL_STRING("", name);
}

static void test_a_request_to_shelve_is_there_until_it_is_done(void)
{
	struct ows_command_shelf *shelf = giving_shelf(&controller);
	struct controller_shelf got;

	TEST_ASSERT_FALSE(controller_shelf(&controller.memory, &got));
	shelf->record = NUMBER;
	shelf->seconds = 60;
	memset(shelf->why, 'y', OWS_TEXT);
	shelf->count = 1;
	TEST_ASSERT_TRUE(controller_shelf(&controller.memory, &got));
	TEST_ASSERT_EQUAL_UINT32(NUMBER, got.record);
	TEST_ASSERT_EQUAL_UINT(OWS_TEXT - 1, strlen(got.why));
	controller_shelf_done(&controller.memory, 1, -EAGAIN);
	TEST_ASSERT_FALSE(controller_shelf(&controller.memory, &got));
	TEST_ASSERT_EQUAL_INT(-EAGAIN, shelf->err);
	shelf->count = 2;
	shelf->record = SIGNALS + 1;
	shelf->person = OWS_PERSONS + 1;
	TEST_ASSERT_TRUE(controller_shelf(&controller.memory, &got));
	TEST_ASSERT_EQUAL_UINT32(0, got.record);
	TEST_ASSERT_EQUAL_UINT32(0, got.person);
}

static void test_the_next_memory_has_what_this_one_had_and_nothing_of_it_is_new(void)
{
	uint32_t rows[SIGNALS];
	struct controller_command c;

	for (uint32_t i = 0; i < SIGNALS; i++)
		rows[i] = UINT32_MAX;
	rows[0] = NUMBER - 1;
	rows[3] = STRING - 1; /* the text has moved */
	giving_set(&controller, NUMBER, 42);
	giving_set_text(&controller, STRING, "boiler");
	giving_slot(&controller, NUMBER)->one_shot = 3;
	giving_slot(&controller, NUMBER)->dgn_reset = 3 * OWS_STEP_READ;
	giving_name_person(&controller, 0, "anna");
	giving_beat(&controller, 500);
	controller_taken(&controller.memory, NUMBER, 1, 0);
	controller_applied(&controller.memory, NUMBER, 1);
	controller_copy(&next.memory, &controller.memory, rows);
	controller_load(&next.memory, NUMBER, &c);
	TEST_ASSERT_EQUAL_INT64(42, c.value);
	TEST_ASSERT_EQUAL_UINT32(1, c.stamp);
	TEST_ASSERT_FALSE(c.fresh || c.one_shot || c.read_once);
	TEST_ASSERT_EQUAL_UINT32(1, giving_slot(&next, NUMBER)->applied);
	TEST_ASSERT_EQUAL_INT(0, giving_slot(&next, NUMBER)->err);
	TEST_ASSERT_EQUAL_INT(6, controller_text(&next.memory, 4, text));
	/* nobody looked at this one: its set has returned -ESTALE */
	TEST_ASSERT_EQUAL_INT(-ESTALE, giving_slot(&next, 4)->err);
	controller_person(&next.memory, 1, text);
	TEST_ASSERT_EQUAL_STRING("anna", text);
	TEST_ASSERT_EQUAL_UINT32(500, giving_header(&next)->period_ms);
}

static uint32_t random_number(void)
{
	static uint32_t x = 2463534242u;

	x ^= x << 13;
	x ^= x >> 17;
	return x ^= x << 5;
}

static void test_rubbish_in_the_memory_harms_nothing(void)
{
	uint32_t rows[SIGNALS];
	struct controller_command command;
	struct controller_shelf shelf;
	struct controller_beat beat;
	char name[OWS_NAME];

	for (uint32_t i = 0; i < SIGNALS; i++)
		rows[i] = i;
	for (int round = 0; round < 500; round++) {
		for (uint32_t i = 0; i < layout.header.size; i += 4)
			((uint32_t *)(void *)controller.memory.base)[i / 4] =
				round % 2 ? random_number() : random_number() % 70;
		for (int i = 0, at = 0; i < 3 * SIGNALS && at >= 0; i++)
			at = controller_next_dirty(&controller.memory, (uint32_t)at);
		for (uint32_t i = 0; i <= SIGNALS; i++) {
			controller_load(&controller.memory, i, &command);
			TEST_ASSERT_TRUE(command.person <= OWS_PERSONS);
			TEST_ASSERT_TRUE(command.read_enable <= 2 && command.write_enable <= 2);
			controller_person(&controller.memory, command.person, name);
			TEST_ASSERT_TRUE(strnlen(name, OWS_NAME) < OWS_NAME);
			if (layout.places[i] != CONTROLLER_NO_TEXT)
				TEST_ASSERT_TRUE(controller_text(&controller.memory, i, text) <=
				                 (int)layout.header.text_cap);
		}
		controller_shelf(&controller.memory, &shelf);
		TEST_ASSERT_TRUE(shelf.record <= SIGNALS && shelf.person <= OWS_PERSONS);
		controller_beat(&controller.memory, &beat);
		controller_copy(&next.memory, &controller.memory, rows);
		TEST_ASSERT_EQUAL_HEX32(OWS_CONTROLLER_MAGIC, giving_header(&next)->magic);
		TEST_ASSERT_EQUAL_UINT32(layout.header.size, giving_header(&next)->size);
	}
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_the_areas_of_a_memory_lie_apart_and_inside);
	RUN_TEST(test_a_layout_that_no_offset_reaches_is_refused);
	RUN_TEST(test_a_command_is_fresh_until_it_was_taken);
	RUN_TEST(test_each_edge_counts_once);
	RUN_TEST(test_numbers_out_of_their_range_count_as_nothing);
	RUN_TEST(test_marks_are_found_in_order_and_once);
	RUN_TEST(test_marks_of_slots_that_do_not_exist_are_nothing);
	RUN_TEST(test_a_text_with_a_wrong_length_or_check_is_refused);
	RUN_TEST(test_names_are_cut_and_without_control_characters_and_quotes);
	RUN_TEST(test_a_request_to_shelve_is_there_until_it_is_done);
	RUN_TEST(test_the_next_memory_has_what_this_one_had_and_nothing_of_it_is_new);
	RUN_TEST(test_rubbish_in_the_memory_harms_nothing);
	return UNITY_END();
}
