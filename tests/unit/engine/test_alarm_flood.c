/* SPDX-License-Identifier: MIT */
/* Nothing that fails for ever fills the journal of alarms: it has room for 256 entries. */
#include <errno.h>
#include <string.h>

#include "unity.h"

#include "tests/unit/aid/alarm_scene.h"

static struct scene s;
static bool latch_stuck;
static const char *stuck; /* at this */

void setUp(void)
{
	scene_init(&s);
	latch_stuck = false;
	stuck = "8";
}
void tearDown(void)
{
	scene_end(&s);
}

static unsigned journal(void)
{
	return s.image.header->alarm_head;
}

static void on_read(struct scene *scene, const char *path)
{
	if (latch_stuck)
		scene_put(scene, D "/latch.BYTE", stuck, 0);
	alarm_on_read(scene, path);
}

/* What is wrong from now on, while the latch of D is set. */
static void nothing(void)
{
}

static void latch_stays_set(void)
{
	latch_stuck = true;
}

static void reset_is_refused(void)
{
	scene_refuse_writes(&s, D "/latch.BYTE", -EIO);
	scene_refuse_writes(&s, "/alarm" D "/latch.BYTE", -EIO);
}

static void latch_cannot_be_read(void)
{
	scene_put(&s, D "/latch.BYTE", NULL, -EIO);
	s.on_read = NULL;
}

static void value_cannot_be_read(void)
{
	scene_put(&s, D "/sensed.BYTE", NULL, -EIO);
	scene_put(&s, "/alarm" D "/sensed.BYTE", NULL, -EIO);
}

static void por_cannot_be_read(void)
{
	scene_put(&s, D "/por", NULL, -ENOENT);
	s.on_read = NULL;
}

static void por_is_no_flag(void)
{
	scene_put(&s, D "/por", "busy", 0);
	s.on_read = NULL;
}

static void por_cannot_be_cleared(void)
{
	scene_put(&s, D "/por", "1", 0);
	scene_refuse_writes(&s, D "/por", -EIO);
}

static void begin_with(const char *reset_latch)
{
	struct config_item *item = figure_3_3(&s);

	if (reset_latch)
		item->reset_latch = reset_latch;
	alarm_device(&s, "0", "0");
	alarm_begin(&s);
	s.on_read = on_read;
	s.no_trace = true;
	scene_put(&s, D "/latch.BYTE", "8", 0);
	judge_alarm(&s);
}

static void begin(void)
{
	begin_with(NULL);
}

static void test_whatever_fails_for_an_hour_the_journal_does_not_grow(void)
{
	static const struct {
		const char *name;
		void (*happens)(void);
	} faults[] = {
		{"nothing", nothing},
		{"the latch stays set after its reset", latch_stays_set},
		{"the reset is refused", reset_is_refused},
		{"the latch cannot be read", latch_cannot_be_read},
		{"the value cannot be read", value_cannot_be_read},
		{"por cannot be read", por_cannot_be_read},
		{"por is no flag", por_is_no_flag},
		{"por cannot be cleared", por_cannot_be_cleared},
	};

	for (unsigned i = 0; i < sizeof(faults) / sizeof(faults[0]); i++) {
		unsigned head;

		begin();
		faults[i].happens();
		scene_run(&s, 10 * SCENE_S);
		head = journal();
		TEST_ASSERT_LESS_OR_EQUAL_UINT_MESSAGE(2, head, faults[i].name);
		scene_run(&s, 3600 * SCENE_S);
		TEST_ASSERT_EQUAL_UINT_MESSAGE(head, journal(), faults[i].name);
		scene_end(&s);
		setUp();
	}
	begin();
}

static void test_occurrences_without_a_rest_between_are_counted_and_entered_once(void)
{
	begin();
	latch_stays_set();
	scene_run(&s, 10 * SCENE_S);
	TEST_ASSERT_GREATER_THAN_UINT32(10, scene_attrs(&s, 1).alarms);
	TEST_ASSERT_EQUAL_UINT(1, journal());
	/* at each moment: reset, or read and not yet reset */
	for (unsigned i = 0; i < 100; i++) {
		TEST_ASSERT_BITS_HIGH(OWS_ATTR_ALARM_STANDS, scene_attrs(&s, 1).flags);
		scene_run(&s, 7 * SCENE_MS);
	}
	latch_stuck = false;
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT(2, journal());
	TEST_ASSERT_BITS_LOW(OWS_ATTR_ALARM_STANDS, scene_attrs(&s, 1).flags);
	TEST_ASSERT_EQUAL_UINT8(OWS_ALARM_RETURNED, s.image.alarms[1].event);
	scene_put(&s, D "/latch.BYTE", "8", 0);
	scene_run(&s, SCENE_S);
	TEST_ASSERT_EQUAL_UINT(4, journal());
}

static void test_another_channel_is_entered_beside_one_whose_latch_is_always_set(void)
{
	begin();
	latch_stays_set();
	scene_run(&s, 10 * SCENE_S);
	TEST_ASSERT_EQUAL_UINT(1, journal());
	stuck = "12";
	scene_run(&s, 10 * SCENE_S);
	TEST_ASSERT_EQUAL_UINT(2, journal());
	TEST_ASSERT_EQUAL_STRING("12", s.image.alarms[1].text);
	/* it comes and goes: that is known */
	for (unsigned i = 0; i < 100; i++) {
		stuck = i & 1 ? "12" : "8";
		scene_run(&s, 500 * SCENE_MS);
	}
	TEST_ASSERT_EQUAL_UINT(2, journal());
}

/* The second door opens while the latch of the first is still set. */
static void another_channel_joins(void)
{
	unsigned head;

	scene_run(&s, 10 * SCENE_S);
	TEST_ASSERT_EQUAL_UINT32(1, scene_attrs(&s, 1).alarms);
	head = journal();
	scene_put(&s, D "/latch.BYTE", "12", 0);
	scene_run(&s, 70 * SCENE_S);
	TEST_ASSERT_EQUAL_UINT32(2, scene_attrs(&s, 1).alarms);
	TEST_ASSERT_EQUAL_UINT(head + 1, journal());
	TEST_ASSERT_EQUAL_STRING("12", s.image.alarms[head].text);
	scene_put(&s, D "/latch.BYTE", "4", 0);
	scene_run(&s, 70 * SCENE_S);
	TEST_ASSERT_EQUAL_UINT32(2, scene_attrs(&s, 1).alarms);
}

static void test_another_channel_is_entered_beside_one_that_nothing_resets(void)
{
	begin_with("");
	another_channel_joins();
}

static void test_another_channel_is_entered_though_the_reset_is_refused(void)
{
	begin();
	reset_is_refused();
	another_channel_joins();
}

static void test_a_latch_of_any_form_is_entered(void)
{
	static const char *const forms[] = {
		"1",       "   8",
		"yes",     "1.5",
		"-1",      "4294967296",
		"0,0,1",   "no,yes",
		" 0 , 1 ", "0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,1", /* longer than what is kept of it */
	};

	for (unsigned i = 0; i < sizeof(forms) / sizeof(forms[0]); i++) {
		begin();
		stuck = forms[i];
		latch_stays_set();
		scene_put(&s, D "/latch.BYTE", stuck, 0);
		scene_run(&s, SCENE_S);
		TEST_ASSERT_EQUAL_UINT_MESSAGE(1, journal(), forms[i]);
		scene_end(&s);
		setUp();
	}
	begin();
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_whatever_fails_for_an_hour_the_journal_does_not_grow);
	RUN_TEST(test_occurrences_without_a_rest_between_are_counted_and_entered_once);
	RUN_TEST(test_a_latch_of_any_form_is_entered);
	RUN_TEST(test_another_channel_is_entered_beside_one_whose_latch_is_always_set);
	RUN_TEST(test_another_channel_is_entered_beside_one_that_nothing_resets);
	RUN_TEST(test_another_channel_is_entered_though_the_reset_is_refused);
	return UNITY_END();
}
