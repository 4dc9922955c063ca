/* SPDX-License-Identifier: MIT */
/* The alarms that stand, in the words of list and watch. */
#include <string.h>

#include "unity.h"

#include "src/faces/show/present.h"
#include "src/tool/owsctl/rows.h"

void setUp(void)
{
}

void tearDown(void)
{
}

static void test_each_state_has_its_words_and_its_mark(void)
{
	static const struct {
		struct ows_alarm_state state;
		const char *words;
		bool eyes;
	} rows[] = {
		{{0}, "-", false},
		{{.limits = 1, .item = 1}, "-", false},
		{{.limit_state = OWS_LIMIT_UNACKNOWLEDGED, .limit_kind = OWS_ALARM_H},
	         "! high",
	         true},
		{{.limit_state = OWS_LIMIT_UNACKNOWLEDGED, .limit_kind = OWS_ALARM_LL},
	         "! low low",
	         true},
		{{.limit_state = OWS_LIMIT_ACKNOWLEDGED, .limit_kind = OWS_ALARM_HH},
	         "high high, acknowledged",
	         false},
		{{.limit_state = OWS_LIMIT_RETURNED, .limit_kind = OWS_ALARM_BAD},
	         "! bad, returned",
	         true},
		{{.item = 1, .stands = 1}, "! device", true},
		{{.item = 1, .polled = 1}, "-", false},
		{{.item = 1, .unarmed = OWS_UNARMED_SET}, "! cannot be armed", true},
		{{.item = 1, .unarmed = OWS_UNARMED_LATCH}, "! cannot be read", true},
		{{.item = 1, .unarmed = OWS_UNARMED_RESET}, "! cannot be reset", true},
		{{.item = 1, .unarmed = OWS_UNARMED_POR_READ}, "! cannot be read", true},
		{{.item = 1, .unarmed = OWS_UNARMED_NO_LATCH}, "! can do nothing", true},
		{{.item = 1, .stands = 1, .unarmed = OWS_UNARMED_STAYS},
	         "! not cleared by ResetLatch",
	         true},
		{{.item = 1,
	          .unarmed = 1,
	          .stands = 1,
	          .limit_state = OWS_LIMIT_ACKNOWLEDGED,
	          .limit_kind = OWS_ALARM_L},
	         "! cannot be armed; low, acknowledged",
	         true},
		{{.stands = 1, .limit_state = OWS_LIMIT_ACKNOWLEDGED, .limit_kind = OWS_ALARM_L},
	         "! device; low, acknowledged",
	         true},
		{{.stands = 1,
	          .limit_state = OWS_LIMIT_UNACKNOWLEDGED,
	          .limit_kind = OWS_ALARM_STALE},
	         "! device; ! stale",
	         true},
	};
	char words[STANDING_WORDS];

	for (size_t i = 0; i < sizeof(rows) / sizeof(rows[0]); i++) {
		TEST_ASSERT_EQUAL_STRING(rows[i].words, standing_text(&rows[i].state, words));
		TEST_ASSERT_EQUAL(rows[i].eyes, standing_wants_eyes(&rows[i].state));
		TEST_ASSERT_EQUAL(rows[i].words[0] != '-', standing_any(&rows[i].state));
		/* the mark and the colour say the same */
		TEST_ASSERT_EQUAL(rows[i].eyes, rows[i].words[0] == '!');
	}
}

static void test_no_words_are_cut(void)
{
	char words[STANDING_WORDS];

	for (unsigned kind = 0; kind < 256; kind++)
		for (unsigned state = 0; state < 256; state++) {
			struct ows_alarm_state odd = {.unarmed = OWS_UNARMED_RESET,
			                              .limit_state = (uint8_t)state,
			                              .limit_kind = (uint8_t)kind};

			TEST_ASSERT_TRUE(strlen(standing_text(&odd, words)) < STANDING_WORDS - 1);
		}
}

static void test_a_signal_without_limits_has_no_alarm_column(void)
{
	TEST_ASSERT_FALSE(standing_possible(&(struct ows_alarm_state){0}));
	TEST_ASSERT_TRUE(standing_possible(&(struct ows_alarm_state){.item = 1}));
	TEST_ASSERT_TRUE(standing_possible(&(struct ows_alarm_state){.limits = 1}));
}

/* What watch prints in a line, a change of it is worth a line. */
static void test_whatever_changes_the_words_of_an_alarm_is_a_change_of_its_row(void)
{
	static const struct ows_alarm_state states[] = {
		{0},
		{.stands = 1},
		{.unarmed = 1},
		{.unarmed = OWS_UNARMED_RESET},
		{.unarmed = 1, .limit_state = OWS_LIMIT_UNACKNOWLEDGED},
		{.limit_state = OWS_LIMIT_UNACKNOWLEDGED, .limit_kind = OWS_ALARM_H},
		{.limit_state = OWS_LIMIT_UNACKNOWLEDGED, .limit_kind = OWS_ALARM_HH},
		{.limit_state = OWS_LIMIT_ACKNOWLEDGED, .limit_kind = OWS_ALARM_HH},
	};
	static const size_t count = sizeof(states) / sizeof(states[0]);
	static struct reading reading;
	char before[STANDING_WORDS], after[STANDING_WORDS];

	for (size_t i = 0; i < count * count; i++) {
		struct row row = {.alarms = states[i / count]};

		TEST_ASSERT_TRUE(row_changed(&row, &reading));
		TEST_ASSERT_FALSE(row_changed(&row, &reading));
		standing_text(&row.alarms, before);
		row.alarms = states[i % count];
		standing_text(&row.alarms, after);
		TEST_ASSERT_EQUAL_MESSAGE(strcmp(before, after) != 0, row_changed(&row, &reading),
		                          after);
	}
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_each_state_has_its_words_and_its_mark);
	RUN_TEST(test_no_words_are_cut);
	RUN_TEST(test_whatever_changes_the_words_of_an_alarm_is_a_change_of_its_row);
	RUN_TEST(test_a_signal_without_limits_has_no_alarm_column);
	return UNITY_END();
}
