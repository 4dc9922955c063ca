/* SPDX-License-Identifier: MIT */
/* Limit alarms that are shelved for a time: what is shown, and when they come back. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "src/daemon/engine/limits/limits.h"
#include "src/daemon/engine/publish.h"
#include "src/daemon/engine/state.h"
#include "tests/unit/aid/scene.h"

#define T1 "/28.000000000001/temperature"
#define T2 "/28.000000000002/temperature"
#define HOUR 3600u

static const struct ows_who anna = {
	.serial = 7, .uid = 1000, .pid = 4711, .name = "plc", .person = "Anna"};

static struct scene s;
static struct config_item *room;

static struct config_limits above(double limit)
{
	return (struct config_limits){
		.any = true,
		.has = {[CONFIG_LIMIT_H] = true, [CONFIG_LIMIT_HH] = true},
		.limit = {[CONFIG_LIMIT_H] = limit, [CONFIG_LIMIT_HH] = limit + 10}};
}

void setUp(void)
{
	scene_init(&s);
	room = scene_input(&s, "room", T1, OWS_DOUBLE);
	room->limits = above(30);
	scene_input(&s, "other", T2, OWS_DOUBLE);
	scene_put(&s, T1, "20", 0);
	scene_put(&s, T2, "20", 0);
}

void tearDown(void)
{
	scene_end(&s);
}

static void up(void)
{
	scene_up(&s);
	scene_run(&s, 300 * SCENE_MS);
}

static void start(void)
{
	scene_start(&s);
	up();
}

static void measure(const char *text)
{
	scene_put(&s, T1, text, 0);
	scene_run(&s, 200 * SCENE_MS);
}

static int shelve_row(uint32_t row, uint32_t seconds, const char *why)
{
	struct signal *signal = &s.engine->table.signals[row];
	int err = engine_shelve(s.engine, signal, seconds, &anna, why);

	engine_publish(s.engine, signal);
	return err;
}

static void shelve(uint32_t seconds)
{
	TEST_ASSERT_EQUAL(0, shelve_row(0, seconds, "defrosting"));
}

static void acknowledge(void)
{
	engine_limits_acknowledge(s.engine, &s.engine->table.signals[0], &anna);
	engine_publish(s.engine, &s.engine->table.signals[0]);
}

static const struct image *image(void)
{
	return s.engine->image;
}

static uint32_t entered(void)
{
	return image()->header->alarm_head;
}

static const struct ows_journal_entry *entry(uint32_t number)
{
	TEST_ASSERT_LESS_THAN(entered(), number);
	return &image()->alarms[number % OWS_JOURNAL];
}

static struct ows_attrs attrs(void)
{
	const struct ows_record *r = &image()->records[1];

	return r->slot[r->seq / 2 & 1].attrs;
}

static void expect(enum ows_limit_state state, uint8_t kind, bool shelved)
{
	TEST_ASSERT_EQUAL(state, attrs().limit_state);
	TEST_ASSERT_EQUAL(kind, attrs().limit_condition);
	TEST_ASSERT_EQUAL(shelved, attrs().shelved);
}

static unsigned shelves(void)
{
	unsigned n = 0;

	for (unsigned i = 0; i < OWS_SHELVES; i++)
		n += image()->shelves[i].record != 0;
	return n;
}

static void test_a_shelved_alarm_is_in_image_and_journal_with_who_and_why(void)
{
	const struct ows_shelf_entry *shelf;

	start();
	shelf = &image()->shelves[0];
	shelve(HOUR);
	expect(OWS_LIMIT_NORMAL, 0, true);
	TEST_ASSERT_EQUAL(1, shelves());
	TEST_ASSERT_EQUAL(1, shelf->record);
	TEST_ASSERT_EQUAL_INT64(s.now_ns + HOUR * SCENE_S, shelf->until_ns);
	TEST_ASSERT_EQUAL_STRING("Anna", shelf->who.person);
	TEST_ASSERT_EQUAL_STRING("defrosting", shelf->why);
	TEST_ASSERT_EQUAL(1, entered());
	TEST_ASSERT_EQUAL(OWS_ALARM_SHELVED, entry(0)->event);
	TEST_ASSERT_EQUAL_MEMORY(&anna, &entry(0)->who, sizeof(anna));
	TEST_ASSERT_EQUAL_STRING("defrosting", entry(0)->text);
	TEST_ASSERT_EQUAL(0, entry(0)->flags);
}

static void test_nothing_is_entered_while_an_alarm_is_shelved(void)
{
	start();
	shelve(HOUR);
	measure("31");
	expect(OWS_LIMIT_NORMAL, OWS_ALARM_H, true);
	measure("45");
	expect(OWS_LIMIT_NORMAL, OWS_ALARM_HH, true);
	acknowledge();
	measure("20");
	expect(OWS_LIMIT_NORMAL, 0, true);
	TEST_ASSERT_EQUAL(1, entered());
}

static void test_an_alarm_that_stands_is_raised_when_the_time_is_over(void)
{
	start();
	shelve(5);
	measure("31");
	scene_run(&s, 4500 * SCENE_MS);
	expect(OWS_LIMIT_NORMAL, OWS_ALARM_H, true);
	scene_run(&s, 600 * SCENE_MS);
	expect(OWS_LIMIT_UNACKNOWLEDGED, OWS_ALARM_H, false);
	TEST_ASSERT_EQUAL(3, entered());
	TEST_ASSERT_EQUAL(OWS_ALARM_UNSHELVED, entry(1)->event);
	TEST_ASSERT_EQUAL(0, entry(1)->who.serial);
	TEST_ASSERT_EQUAL(OWS_ALARM_RAISED, entry(2)->event);
	TEST_ASSERT_EQUAL(OWS_ALARM_H, entry(2)->kind);
	TEST_ASSERT_EQUAL(0, shelves());
}

static void test_an_alarm_that_does_not_stand_is_normal_when_the_time_is_over(void)
{
	start();
	measure("31");
	shelve(5);
	measure("20");
	scene_run(&s, 6 * SCENE_S);
	expect(OWS_LIMIT_NORMAL, 0, false);
	TEST_ASSERT_EQUAL(3, entered());
	TEST_ASSERT_EQUAL(OWS_ALARM_UNSHELVED, entry(2)->event);
}

static void test_an_alarm_that_was_acknowledged_is_raised_anew_when_it_is_unshelved(void)
{
	start();
	measure("31");
	acknowledge();
	TEST_ASSERT_EQUAL(OWS_ALARM_ACKNOWLEDGED, entry(1)->event);
	TEST_ASSERT_EQUAL_STRING("Anna", entry(1)->who.person);
	shelve(HOUR);
	expect(OWS_LIMIT_NORMAL, OWS_ALARM_H, true);
	shelve(0);
	expect(OWS_LIMIT_UNACKNOWLEDGED, OWS_ALARM_H, false);
	TEST_ASSERT_EQUAL(OWS_ALARM_UNSHELVED, entry(3)->event);
	TEST_ASSERT_EQUAL_STRING("Anna", entry(3)->who.person);
	TEST_ASSERT_EQUAL(OWS_ALARM_RAISED, entry(4)->event);
}

static void test_the_time_goes_on_while_the_machine_sleeps(void)
{
	start();
	shelve(HOUR);
	measure("31");
	s.now_ns += 2 * HOUR * SCENE_S;
	scene_run(&s, 300 * SCENE_MS);
	expect(OWS_LIMIT_UNACKNOWLEDGED, OWS_ALARM_H, false);
}

static void test_the_time_is_over_for_a_signal_that_is_not_read(void)
{
	start();
	measure("31");
	shelve(5);
	scene_slot(&s, 1)->read_enable = 1;
	scene_ring(&s, 1);
	scene_run(&s, 6 * SCENE_S);
	TEST_ASSERT_EQUAL_HEX8(OWS_Q_DISABLED, scene_sample(&s, 1).quality);
	expect(OWS_LIMIT_UNACKNOWLEDGED, OWS_ALARM_H, false);
}

static void test_shelved_anew_it_has_the_new_time(void)
{
	start();
	shelve(2);
	shelve(HOUR);
	scene_run(&s, 5 * SCENE_S);
	expect(OWS_LIMIT_NORMAL, 0, true);
	TEST_ASSERT_EQUAL(1, shelves());
	shelve(1);
	scene_run(&s, 2 * SCENE_S);
	expect(OWS_LIMIT_NORMAL, 0, false);
}

static void test_to_unshelve_what_is_not_shelved_does_nothing(void)
{
	start();
	measure("31");
	shelve(0);
	expect(OWS_LIMIT_UNACKNOWLEDGED, OWS_ALARM_H, false);
	TEST_ASSERT_EQUAL(1, entered());
}

static void test_what_cannot_be_shelved_is_refused(void)
{
	start();
	TEST_ASSERT_EQUAL(-EOPNOTSUPP, shelve_row(1, HOUR, ""));
	TEST_ASSERT_EQUAL(-ERANGE, shelve_row(0, OWS_SHELVE_MAX + 1, ""));
	TEST_ASSERT_EQUAL(-ERANGE, shelve_row(0, UINT32_MAX, ""));
	TEST_ASSERT_EQUAL(0, shelve_row(0, OWS_SHELVE_MAX, ""));
	TEST_ASSERT_EQUAL(1, entered());
}

static void test_a_reason_without_end_is_cut(void)
{
	char why[OWS_TEXT];

	memset(why, 'x', sizeof(why));
	start();
	TEST_ASSERT_EQUAL(0, shelve_row(0, HOUR, why));
	TEST_ASSERT_EQUAL(OWS_TEXT - 1, strlen(image()->shelves[0].why));
	TEST_ASSERT_EQUAL(OWS_TEXT - 1, strlen(entry(0)->text));
}

static void test_a_full_table_refuses_the_next_and_takes_it_when_one_is_free(void)
{
	start();
	for (unsigned i = 0; i < OWS_SHELVES; i++)
		s.engine->image->shelves[i].record = 2;
	TEST_ASSERT_EQUAL(-ENOSPC, shelve_row(0, HOUR, ""));
	expect(OWS_LIMIT_NORMAL, 0, false);
	TEST_ASSERT_EQUAL(0, entered());
	s.engine->image->shelves[63].record = 0;
	TEST_ASSERT_EQUAL(0, shelve_row(0, HOUR, ""));
	TEST_ASSERT_EQUAL(1, s.engine->image->shelves[63].record);
}

static void test_requests_without_end_are_refused_but_for_one_a_second(void)
{
	start();
	for (unsigned i = 0; i < 1000; i++)
		shelve_row(0, i % 2 ? 0 : HOUR, "");
	TEST_ASSERT_EQUAL(64, entered());
	TEST_ASSERT_EQUAL(-EAGAIN, shelve_row(0, HOUR, ""));
	scene_run(&s, 3100 * SCENE_MS);
	for (unsigned i = 0; i < 1000; i++)
		shelve_row(0, HOUR, "");
	TEST_ASSERT_EQUAL(67, entered());
	scene_run(&s, 1000 * SCENE_S);
	TEST_ASSERT_EQUAL(0, shelve_row(0, HOUR, ""));
}

/* --- Reload and restart ---------------------------------------------------------------------- */

static void rename_path(struct config *config)
{
	config->items[0].path = T2;
}

static void rename_signal(struct config *config)
{
	config->items[0].name = "cellar";
}

static void replace_signal(struct config *config)
{
	rename_path(config);
	rename_signal(config);
}

static void turn_round(struct config *config)
{
	struct config_item first = config->items[0];

	config->items[0] = config->items[1];
	config->items[1] = first;
}

static void take_limits(struct config *config)
{
	config->items[0].limits = (struct config_limits){0};
}

static void test_a_reload_keeps_what_is_shelved(void)
{
	start();
	shelve(5);
	measure("31");
	scene_reload(&s, NULL);
	scene_run(&s, SCENE_S);
	expect(OWS_LIMIT_NORMAL, OWS_ALARM_H, true);
	TEST_ASSERT_EQUAL_STRING("defrosting", image()->shelves[0].why);
	scene_run(&s, 5 * SCENE_S);
	expect(OWS_LIMIT_UNACKNOWLEDGED, OWS_ALARM_H, false);
}

static void test_a_reload_finds_what_is_shelved_by_its_name(void)
{
	start();
	shelve(HOUR);
	scene_reload(&s, turn_round);
	TEST_ASSERT_EQUAL(1, shelves());
	TEST_ASSERT_EQUAL(2, image()->shelves[0].record);
	expect(OWS_LIMIT_NORMAL, 0, false);
}

static void test_a_signal_of_another_path_stays_shelved_over_a_reload(void)
{
	start();
	shelve(HOUR);
	scene_reload(&s, rename_path);
	scene_run(&s, SCENE_S);
	expect(OWS_LIMIT_NORMAL, 0, true);
}

static void test_a_signal_that_was_renamed_stays_shelved_over_a_reload(void)
{
	start();
	shelve(HOUR);
	scene_reload(&s, rename_signal);
	TEST_ASSERT_EQUAL(1, shelves());
	expect(OWS_LIMIT_NORMAL, 0, true);
}

static void test_a_signal_that_is_gone_gives_its_place_back(void)
{
	start();
	shelve(HOUR);
	scene_reload(&s, replace_signal);
	TEST_ASSERT_EQUAL(0, shelves());
	expect(OWS_LIMIT_NORMAL, 0, false);
}

static void test_a_signal_without_limits_any_more_gives_its_place_back(void)
{
	start();
	shelve(HOUR);
	scene_reload(&s, take_limits);
	TEST_ASSERT_EQUAL(0, shelves());
	TEST_ASSERT_EQUAL(0, attrs().shelved);
}

static void test_a_restart_keeps_what_is_shelved(void)
{
	start();
	shelve(5);
	scene_put(&s, T1, "31", 0);
	scene_restart(&s);
	up();
	expect(OWS_LIMIT_NORMAL, OWS_ALARM_H, true);
	TEST_ASSERT_EQUAL(0, entered());
	TEST_ASSERT_EQUAL_STRING("Anna", image()->shelves[0].who.person);
	scene_run(&s, 6 * SCENE_S);
	expect(OWS_LIMIT_UNACKNOWLEDGED, OWS_ALARM_H, false);
}

static void test_a_time_that_ended_while_owsd_was_down_is_over(void)
{
	start();
	shelve(5);
	scene_put(&s, T1, "31", 0);
	s.now_ns += 10 * SCENE_S;
	scene_restart(&s);
	up();
	expect(OWS_LIMIT_UNACKNOWLEDGED, OWS_ALARM_H, false);
	TEST_ASSERT_EQUAL(OWS_ALARM_UNSHELVED, entry(0)->event);
	TEST_ASSERT_EQUAL(OWS_ALARM_RAISED, entry(1)->event);
}

static void test_a_place_whose_writing_was_broken_off_is_free_after_a_restart(void)
{
	start();
	shelve(HOUR);
	s.image.shelves[0].seq++;
	scene_restart(&s);
	up();
	TEST_ASSERT_EQUAL(0, shelves());
	expect(OWS_LIMIT_NORMAL, 0, false);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_shelved_alarm_is_in_image_and_journal_with_who_and_why);
	RUN_TEST(test_nothing_is_entered_while_an_alarm_is_shelved);
	RUN_TEST(test_an_alarm_that_stands_is_raised_when_the_time_is_over);
	RUN_TEST(test_an_alarm_that_does_not_stand_is_normal_when_the_time_is_over);
	RUN_TEST(test_an_alarm_that_was_acknowledged_is_raised_anew_when_it_is_unshelved);
	RUN_TEST(test_the_time_goes_on_while_the_machine_sleeps);
	RUN_TEST(test_the_time_is_over_for_a_signal_that_is_not_read);
	RUN_TEST(test_shelved_anew_it_has_the_new_time);
	RUN_TEST(test_to_unshelve_what_is_not_shelved_does_nothing);
	RUN_TEST(test_what_cannot_be_shelved_is_refused);
	RUN_TEST(test_a_reason_without_end_is_cut);
	RUN_TEST(test_a_full_table_refuses_the_next_and_takes_it_when_one_is_free);
	RUN_TEST(test_requests_without_end_are_refused_but_for_one_a_second);
	RUN_TEST(test_a_reload_keeps_what_is_shelved);
	RUN_TEST(test_a_reload_finds_what_is_shelved_by_its_name);
	RUN_TEST(test_a_signal_of_another_path_stays_shelved_over_a_reload);
	RUN_TEST(test_a_signal_that_was_renamed_stays_shelved_over_a_reload);
	RUN_TEST(test_a_signal_that_is_gone_gives_its_place_back);
	RUN_TEST(test_a_signal_without_limits_any_more_gives_its_place_back);
	RUN_TEST(test_a_restart_keeps_what_is_shelved);
	RUN_TEST(test_a_time_that_ended_while_owsd_was_down_is_over);
	RUN_TEST(test_a_place_whose_writing_was_broken_off_is_free_after_a_restart);
	return UNITY_END();
}
