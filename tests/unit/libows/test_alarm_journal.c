/* SPDX-License-Identifier: MIT */
/* The journal of alarms, from the writer's side to a consumer. */
#include <errno.h>
#include <pthread.h>
#include <string.h>

#include "unity.h"

#include "src/ground/signal/value.h"
#include "src/memory/shm/entries.h"
#include "tests/unit/aid/instance.h"

static const struct instance_signal signals[] = {
	{"room1", "/28.1/temperature", OWS_DOUBLE, false, 0},
	{"door", "/29.1/sensed.BYTE", OWS_BYTE, false, 0},
};
enum { ROOM = 1, DOOR };

static struct instance in;
static struct ows *h;

void setUp(void)
{
	instance_start(&in, "journal", signals, 2);
	TEST_ASSERT_EQUAL(0, ows_open(in.name, OWS_READ, &h));
}

void tearDown(void)
{
	ows_close(h);
	instance_end(&in);
}

static struct ows_journal_entry door_alarm(int64_t before)
{
	return (struct ows_journal_entry){
		.record = DOOR,
		.occurred_ns = 7 * INSTANCE_S,
		.before = before,
		.kind = OWS_ALARM_DEVICE,
		.event = OWS_ALARM_RAISED,
		.quality = OWS_Q_GOOD,
		.flags = OWS_JOURNAL_BEFORE,
		.text = "0,1,0,0,0,0,0,0",
	};
}

static void test_a_journal_begins_empty(void)
{
	struct ows_alarm alarm;

	TEST_ASSERT_EQUAL(0, ows_alarm_count(h));
	TEST_ASSERT_EQUAL(-ENOENT, ows_alarm(h, 0, &alarm));
	TEST_ASSERT_EQUAL(-ENOENT, ows_alarm(h, UINT32_MAX, &alarm));
}

static void test_an_alarm_is_read_as_it_was_entered(void)
{
	struct ows_journal_entry entry = door_alarm(3);
	struct ows_alarm alarm;

	TEST_ASSERT_EQUAL(0, image_alarm(&in.image, &entry));
	TEST_ASSERT_EQUAL(1, ows_alarm_count(h));
	TEST_ASSERT_EQUAL(0, ows_alarm(h, 0, &alarm));
	TEST_ASSERT_EQUAL(DOOR - 1, alarm.signal);
	TEST_ASSERT_EQUAL(OWS_BYTE, alarm.type);
	TEST_ASSERT_EQUAL_INT64(7 * INSTANCE_S, alarm.occurred_ns);
	TEST_ASSERT_TRUE(alarm.has_before);
	TEST_ASSERT_FALSE(alarm.has_after);
	TEST_ASSERT_EQUAL_INT64(3, alarm.before_integer);
	TEST_ASSERT_EQUAL_DOUBLE(3, alarm.before);
	TEST_ASSERT_EQUAL(OWS_ALARM_DEVICE, alarm.kind);
	TEST_ASSERT_EQUAL(OWS_ALARM_RAISED, alarm.event);
	TEST_ASSERT_EQUAL(OWS_Q_GOOD, alarm.quality);
	TEST_ASSERT_EQUAL_STRING("0,1,0,0,0,0,0,0", alarm.text);
	TEST_ASSERT_EQUAL(-ENOENT, ows_alarm(h, 1, &alarm));
}

static void test_the_value_after_comes_later(void)
{
	struct ows_journal_entry entry = {
		.record = ROOM, .kind = OWS_ALARM_HH, .event = OWS_ALARM_RAISED};
	struct ows_alarm alarm;
	uint32_t number = image_alarm(&in.image, &entry);

	image_alarm_after(&in.image, number, value_of_double(31.5));
	TEST_ASSERT_EQUAL(0, ows_alarm(h, number, &alarm));
	TEST_ASSERT_FALSE(alarm.has_before);
	TEST_ASSERT_TRUE(alarm.has_after);
	TEST_ASSERT_EQUAL_DOUBLE(31.5, alarm.after);
	TEST_ASSERT_EQUAL(OWS_ALARM_HH, alarm.kind);
	TEST_ASSERT_EQUAL(1, ows_alarm_count(h));
}

static void test_a_latch_may_fill_its_room(void)
{
	struct ows_journal_entry entry = door_alarm(0);
	struct ows_alarm alarm;

	memset(entry.text, '1', sizeof(entry.text));
	image_alarm(&in.image, &entry);
	TEST_ASSERT_EQUAL(0, ows_alarm(h, 0, &alarm));
	TEST_ASSERT_EQUAL(sizeof(entry.text) - 1, strlen(alarm.text));
	TEST_ASSERT_EQUAL_MEMORY(entry.text, alarm.text, sizeof(entry.text) - 1);
}

static void test_the_ring_keeps_the_last_entries(void)
{
	struct ows_alarm alarm;

	for (int64_t i = 0; i < OWS_JOURNAL + 3; i++) {
		struct ows_journal_entry entry = door_alarm(i % 256);

		TEST_ASSERT_EQUAL(i, image_alarm(&in.image, &entry));
	}
	TEST_ASSERT_EQUAL(OWS_JOURNAL + 3, ows_alarm_count(h));
	TEST_ASSERT_EQUAL(-ENOENT, ows_alarm(h, 2, &alarm));
	TEST_ASSERT_EQUAL(0, ows_alarm(h, 3, &alarm));
	TEST_ASSERT_EQUAL_INT64(3, alarm.before_integer);
	TEST_ASSERT_EQUAL(0, ows_alarm(h, OWS_JOURNAL + 2, &alarm));
	TEST_ASSERT_EQUAL_INT64(2, alarm.before_integer);
}

static void test_a_value_for_an_entry_no_longer_kept_changes_nothing(void)
{
	struct ows_alarm alarm;

	for (int64_t i = 0; i < OWS_JOURNAL + 1; i++) {
		struct ows_journal_entry entry = door_alarm(1);

		image_alarm(&in.image, &entry);
	}
	image_alarm_after(&in.image, 0, 99);
	image_alarm_after(&in.image, OWS_JOURNAL + 1, 99);
	for (uint32_t i = 1; i < OWS_JOURNAL + 1; i++) {
		TEST_ASSERT_EQUAL(0, ows_alarm(h, i, &alarm));
		TEST_ASSERT_FALSE(alarm.has_after);
	}
}

static void test_numbers_go_on_where_they_wrap(void)
{
	struct ows_journal_entry entry = door_alarm(5);
	struct ows_alarm alarm;

	in.image.header->alarm_head = UINT32_MAX;
	TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, image_alarm(&in.image, &entry));
	TEST_ASSERT_EQUAL(0, image_alarm(&in.image, &entry));
	image_alarm_after(&in.image, UINT32_MAX, 9);
	TEST_ASSERT_EQUAL(0, ows_alarm(h, UINT32_MAX, &alarm));
	TEST_ASSERT_EQUAL_INT64(9, alarm.after_integer);
	TEST_ASSERT_EQUAL(0, ows_alarm(h, 0, &alarm));
	TEST_ASSERT_FALSE(alarm.has_after);
}

static void test_an_entry_broken_off_is_not_shown(void)
{
	struct ows_journal_entry entry = door_alarm(5);
	struct ows_alarm alarm;

	image_alarm(&in.image, &entry);
	image_alarm(&in.image, &entry);
	in.image.alarms[0].seq++;
	TEST_ASSERT_EQUAL(-EAGAIN, ows_alarm(h, 0, &alarm));
	TEST_ASSERT_EQUAL(0, ows_alarm(h, 1, &alarm));
}

static int done;

static void *write_on(void *arg)
{
	for (int64_t n = 0; !__atomic_load_n(&done, __ATOMIC_ACQUIRE); n++) {
		struct ows_journal_entry entry = door_alarm(n);

		entry.occurred_ns = n;
		image_alarm_after(&in.image, image_alarm(&in.image, &entry), n);
	}
	return arg;
}

static void test_entries_are_whole_beside_a_busy_writer(void)
{
	int64_t until = ows_now() + 60 * INSTANCE_S;
	struct ows_alarm alarm;
	unsigned seen = 0;
	pthread_t thread;

	done = 0;
	TEST_ASSERT_EQUAL(0, pthread_create(&thread, NULL, write_on, NULL));
	for (uint32_t i = 0; seen < 20000 && ows_now() < until; i++) {
		uint32_t number = ows_alarm_count(h) - 1 - i % 300;

		if (ows_alarm(h, number, &alarm) != 0)
			continue;
		seen++;
		TEST_ASSERT_EQUAL_INT64(number, alarm.occurred_ns);
		TEST_ASSERT_EQUAL_INT64(number, alarm.before_integer);
		if (alarm.has_after)
			TEST_ASSERT_EQUAL_INT64(number, alarm.after_integer);
	}
	__atomic_store_n(&done, 1, __ATOMIC_RELEASE);
	pthread_join(thread, NULL);
	TEST_ASSERT_EQUAL(20000, seen);
}

static void test_an_entry_carries_its_check_word(void)
{
	struct ows_journal_entry entry = door_alarm(5);

	image_alarm(&in.image, &entry);
	TEST_ASSERT_EQUAL_HEX32(ows_check(&in.image.alarms[0].record, 48),
	                        in.image.alarms[0].check);
}

static void test_an_image_without_a_journal_has_no_alarms(void)
{
	struct ows *old;
	struct ows_alarm alarm;

	in.image.areas[OWS_AREA_ALARMS - 1].kind = OWS_AREAS;
	in.image.header->alarm_head = 1;
	TEST_ASSERT_EQUAL(0, ows_open(in.name, OWS_READ, &old));
	TEST_ASSERT_EQUAL(1, ows_alarm_count(old));
	TEST_ASSERT_EQUAL(-ENOENT, ows_alarm(old, 0, &alarm));
	ows_close(old);
}

static void test_a_journal_outside_the_segment_is_refused(void)
{
	struct ows *broken;

	in.image.areas[OWS_AREA_ALARMS - 1].count = 0x10000000;
	TEST_ASSERT_EQUAL(-EPROTO, ows_open(in.name, OWS_READ, &broken));
}

static void test_every_kind_and_event_has_a_word(void)
{
	for (int i = OWS_ALARM_DEVICE; i <= OWS_ALARM_BAD; i++)
		TEST_ASSERT_NOT_EQUAL(0, strcmp("none", ows_alarm_kind_text((uint8_t)i)));
	for (int i = OWS_ALARM_RAISED; i <= OWS_ALARM_FAILED; i++)
		TEST_ASSERT_NOT_EQUAL(0, strcmp("unknown", ows_alarm_event_text((uint8_t)i)));
	TEST_ASSERT_EQUAL_STRING("none", ows_alarm_kind_text(0));
	TEST_ASSERT_EQUAL_STRING("none", ows_alarm_kind_text(255));
	TEST_ASSERT_EQUAL_STRING("unknown", ows_alarm_event_text(255));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_journal_begins_empty);
	RUN_TEST(test_an_alarm_is_read_as_it_was_entered);
	RUN_TEST(test_the_value_after_comes_later);
	RUN_TEST(test_a_latch_may_fill_its_room);
	RUN_TEST(test_the_ring_keeps_the_last_entries);
	RUN_TEST(test_a_value_for_an_entry_no_longer_kept_changes_nothing);
	RUN_TEST(test_numbers_go_on_where_they_wrap);
	RUN_TEST(test_an_entry_broken_off_is_not_shown);
	RUN_TEST(test_entries_are_whole_beside_a_busy_writer);
	RUN_TEST(test_an_entry_carries_its_check_word);
	RUN_TEST(test_an_image_without_a_journal_has_no_alarms);
	RUN_TEST(test_a_journal_outside_the_segment_is_refused);
	RUN_TEST(test_every_kind_and_event_has_a_word);
	return UNITY_END();
}
