/* SPDX-License-Identifier: MIT */
/* Tests of ows_changes(): what it gives, when it waits, and when all has to be looked at. */
#include <errno.h>
#include <pthread.h>
#include <stdio.h>
#include <time.h>

#include "unity.h"

#include "src/memory/shm/futex.h"
#include "tests/unit/aid/asleep.h"
#include "tests/unit/aid/folder.h"
#include "tests/unit/aid/instance.h"

static const struct instance_signal signals[] = {
	{"a", "/28.1/temperature", OWS_DOUBLE, false, 0},
	{"b", "/29.1/PIO.0", OWS_BOOL, true, 0},
	{"c", "/23.1/memory", OWS_STRING, true, 0},
	{"d", "/1D.1/counters.A", OWS_LARGE, false, 0},
	{"e", "/1D.1/counters.B", OWS_LARGE, false, 0},
};
#define COUNT 5
enum { A, B, C, D, E };

#define MS INT64_C(1000000)
#define ROOM 4096 /* more than the ring has */

static struct instance in;
static struct ows *h;
static struct ows_cursor cursor;
static int ids[ROOM];

static void open_it(void)
{
	cursor = (struct ows_cursor){0};
	TEST_ASSERT_EQUAL(0, ows_open(in.name, OWS_READ, &h));
	TEST_ASSERT_EQUAL(-EOVERFLOW, ows_changes(h, &cursor, ids, ROOM, 0));
}

void setUp(void)
{
	instance_start(&in, "changes", signals, COUNT);
	open_it();
}

void tearDown(void)
{
	ows_close(h);
	instance_end(&in);
}

static int changes(int n)
{
	return ows_changes(h, &cursor, ids, n, 0);
}

/* By the index of a signal, as ows_changes() gives it. */
static void put(int signal, int64_t value)
{
	instance_put(&in, (uint32_t)signal + 1, value, ows_now());
}

static void test_at_the_beginning_all_is_new_and_then_nothing(void)
{
	struct ows_cursor other = {0};

	put(A, 1);
	TEST_ASSERT_EQUAL(-EOVERFLOW, ows_changes(h, &other, ids, ROOM, -1));
	TEST_ASSERT_EQUAL(0, ows_changes(h, &other, ids, ROOM, 0));
}

static void test_what_changed_is_given_by_its_index_and_the_row_is_new(void)
{
	struct ows_value v;

	put(D, 17);
	TEST_ASSERT_EQUAL(1, changes(ROOM));
	TEST_ASSERT_EQUAL(D, ids[0]);
	TEST_ASSERT_EQUAL(0, ows_get_signal(h, ids[0], ows_now(), &v));
	TEST_ASSERT_EQUAL_INT64(17, v.integer);
	TEST_ASSERT_EQUAL(0, changes(ROOM));
}

static void test_a_signal_that_changed_often_stands_once_in_a_batch(void)
{
	for (int i = 0; i < 10; i++) {
		put(B, i & 1);
		put(E, i);
	}
	put(A, 0);
	TEST_ASSERT_EQUAL(3, changes(ROOM));
	TEST_ASSERT_EQUAL(B, ids[0]);
	TEST_ASSERT_EQUAL(E, ids[1]);
	TEST_ASSERT_EQUAL(A, ids[2]);
	put(B, 0);
	TEST_ASSERT_EQUAL(1, changes(ROOM));
	TEST_ASSERT_EQUAL(B, ids[0]);
}

static void test_what_has_no_room_in_the_batch_comes_with_the_next(void)
{
	for (int i = A; i <= E; i++)
		put(i, 0);
	TEST_ASSERT_EQUAL(2, changes(2));
	TEST_ASSERT_EQUAL(A, ids[0]);
	TEST_ASSERT_EQUAL(B, ids[1]);
	TEST_ASSERT_EQUAL(2, changes(2));
	TEST_ASSERT_EQUAL(C, ids[0]);
	TEST_ASSERT_EQUAL(1, changes(2));
	TEST_ASSERT_EQUAL(E, ids[0]);
	TEST_ASSERT_EQUAL(0, changes(2));
	TEST_ASSERT_EQUAL(-EINVAL, changes(0));
}

static void test_two_cursors_of_a_handle_know_nothing_of_each_other(void)
{
	struct ows_cursor other = cursor;

	put(C, 0);
	TEST_ASSERT_EQUAL(1, changes(ROOM));
	TEST_ASSERT_EQUAL(1, ows_changes(h, &other, ids, ROOM, 0));
	TEST_ASSERT_EQUAL(C, ids[0]);
}

static void test_the_numbers_of_changes_may_wrap(void)
{
	uint32_t head = UINT32_MAX - 2;

	in.image.header->change_head = head;
	ows_close(h);
	open_it();
	for (int i = 0; i < 7; i++)
		put(i % COUNT, i);
	TEST_ASSERT_EQUAL_UINT32(4, in.image.header->change_head);
	TEST_ASSERT_EQUAL(COUNT, changes(ROOM));
	for (int i = A; i <= E; i++)
		TEST_ASSERT_EQUAL(i, ids[i]);
	TEST_ASSERT_EQUAL(0, changes(ROOM));
}

static void test_who_fell_behind_the_ring_is_told_so_once(void)
{
	uint32_t count = in.image.change_count;

	TEST_ASSERT_LESS_THAN_UINT32(ROOM, count);
	for (uint32_t i = 0; i < count - 1; i++)
		put((int)(i % COUNT), 0);
	TEST_ASSERT_EQUAL(COUNT, changes(ROOM));
	for (uint32_t i = 0; i < count; i++)
		put((int)(i % COUNT), 0);
	TEST_ASSERT_EQUAL(-EOVERFLOW, changes(ROOM));
	TEST_ASSERT_EQUAL(0, changes(ROOM));
	put(D, 0);
	TEST_ASSERT_EQUAL(1, changes(ROOM));
}

static void test_a_cursor_that_was_left_alone_for_long_is_no_longer_believed(void)
{
	put(D, 0);
	cursor.looked_ns -= 2 * 3600 * INSTANCE_S;
	TEST_ASSERT_EQUAL(-EOVERFLOW, changes(ROOM));
	TEST_ASSERT_EQUAL(0, changes(ROOM));
}

static void test_a_record_that_is_none_of_the_image_is_passed_over(void)
{
	put(A, 0);
	put(B, 0);
	in.image.changes[(in.image.header->change_head - 2) & (in.image.change_count - 1)].record =
		COUNT + 1;
	TEST_ASSERT_EQUAL(1, changes(ROOM));
	TEST_ASSERT_EQUAL(B, ids[0]);
}

static void test_the_time_is_over_when_nothing_changes(void)
{
	int64_t begin = ows_now();

	TEST_ASSERT_EQUAL(0, ows_changes(h, &cursor, ids, ROOM, 20 * MS));
	TEST_ASSERT_GREATER_OR_EQUAL_INT64(20 * MS, ows_now() - begin);
}

static void *change_later(void *ctx)
{
	(void)ctx;
	until_asleep(NULL);
	image_news(&in.image); /* news that are no change wake nobody for long */
	segment_wake(&in.image.header->news, 1000);
	until_asleep(NULL);
	put(E, 1);
	segment_wake(&in.image.header->news, 1000);
	return NULL;
}

static void test_a_sleeper_wakes_for_a_change(void)
{
	pthread_t thread;

	TEST_ASSERT_EQUAL(0, pthread_create(&thread, NULL, change_later, NULL));
	TEST_ASSERT_EQUAL(1, ows_changes(h, &cursor, ids, ROOM, -1));
	TEST_ASSERT_EQUAL(E, ids[0]);
	pthread_join(thread, NULL);
}

static void expect_quality(uint8_t quality)
{
	struct ows_value v;

	ows_get_signal(h, A, ows_now(), &v);
	TEST_ASSERT_EQUAL_HEX8(quality, v.quality);
}

static void test_an_owsd_that_was_killed_changes_all_once_and_its_return_too(void)
{
	ows_close(h);
	instance_dies_soon(&in);
	put(A, 1);
	instance_beat(&in, ows_now() - 1700 * MS, 0); /* of the two seconds it may stand still */
	open_it();
	TEST_ASSERT_EQUAL(-EOVERFLOW, ows_changes(h, &cursor, ids, ROOM, -1));
	expect_quality(OWS_Q_NO_OWSD);
	TEST_ASSERT_EQUAL(0, ows_changes(h, &cursor, ids, ROOM, 10 * MS));
	instance_beat(&in, ows_now(), 0);
	TEST_ASSERT_EQUAL(-EOVERFLOW, ows_changes(h, &cursor, ids, ROOM, -1));
	expect_quality(OWS_Q_GOOD);
}

static void test_an_owsd_that_ended_changes_all_and_the_next_one_is_awaited(void)
{
	struct instance old;

	put(A, 1);
	TEST_ASSERT_EQUAL(1, changes(ROOM));
	image_state(&in.image, OWS_STATE_STOPPED);
	TEST_ASSERT_EQUAL(-EOVERFLOW, ows_changes(h, &cursor, ids, ROOM, -1));
	expect_quality(OWS_Q_NO_OWSD);
	TEST_ASSERT_EQUAL(0, ows_changes(h, &cursor, ids, ROOM, 10 * MS));
	old = in;
	instance_make(&in, "changes", 2, ows_now(), signals, COUNT);
	instance_lives_on(&in);
	instance_show(&in);
	TEST_ASSERT_EQUAL(-ESTALE, ows_changes(h, &cursor, ids, ROOM, -1));
	TEST_ASSERT_EQUAL(0, ows_reopen(h));
	TEST_ASSERT_EQUAL(-EOVERFLOW, ows_changes(h, &cursor, ids, ROOM, -1));
	put(B, 1);
	TEST_ASSERT_EQUAL(1, changes(ROOM));
	instance_leave(&old);
}

static void test_a_reload_is_told_until_the_handle_is_opened_again(void)
{
	int64_t begin;

	put(A, 1);
	instance_reload(&in, signals + 1, COUNT - 1);
	instance_lives_on(&in);
	TEST_ASSERT_EQUAL(-ESTALE, changes(ROOM));
	begin = ows_now();
	TEST_ASSERT_EQUAL(-ESTALE, ows_changes(h, &cursor, ids, ROOM, -1));
	TEST_ASSERT_GREATER_OR_EQUAL_INT64(50 * MS, ows_now() - begin); /* a loop does not spin */
	TEST_ASSERT_EQUAL(0, ows_reopen(h));
	TEST_ASSERT_EQUAL(-EOVERFLOW, changes(ROOM));
	put(0, 1); /* b, which is the first now */
	TEST_ASSERT_EQUAL(1, changes(ROOM));
	TEST_ASSERT_EQUAL(0, ids[0]);
}

static void test_errno_stays_as_it_was(void)
{
	errno = 77;
	ows_changes(h, &cursor, ids, ROOM, MS);
	image_state(&in.image, OWS_STATE_STOPPED);
	remove(folder_file(in.name, "image"));
	ows_changes(h, &cursor, ids, ROOM, MS);
	TEST_ASSERT_EQUAL(77, errno);
}

#define MANY 400000
static uint32_t first;

/* Change number n has value n, and is of signal n % COUNT. */
static void *change_all_the_time(void *ctx)
{
	(void)ctx;
	for (uint32_t i = 0; i < MANY; i++)
		instance_put(&in, (first + i) % COUNT + 1, first + i, 1);
	return NULL;
}

/* All that changed from number from to before, and no other. */
static void judge(uint32_t from, uint32_t before, int got)
{
	uint32_t number = before - from < COUNT ? before - from : COUNT;
	bool there[COUNT] = {0};

	TEST_ASSERT_EQUAL(number, got);
	for (int i = 0; i < got; i++)
		there[ids[i]] = true;
	for (uint32_t n = before - number; n != before; n++) {
		struct ows_value v;

		TEST_ASSERT_TRUE(there[n % COUNT]);
		if (n % COUNT < D)
			continue;
		ows_get_signal(h, (int)(n % COUNT), ows_now(), &v);
		TEST_ASSERT_GREATER_OR_EQUAL_INT64(n, v.integer);
	}
}

static void test_beside_a_busy_writer_nothing_is_missed_or_made_up(void)
{
	uint32_t last, behind = 0, batches = 0;
	pthread_t thread;

	first = in.image.header->change_head;
	last = first + MANY;
	TEST_ASSERT_EQUAL(0, pthread_create(&thread, NULL, change_all_the_time, NULL));
	while (cursor.number != last) {
		uint32_t from = cursor.number;
		int got = ows_changes(h, &cursor, ids, ROOM, 0);

		if (got == -EOVERFLOW) {
			behind++;
			continue;
		}
		judge(from, cursor.number, got);
		batches++;
	}
	pthread_join(thread, NULL);
	TEST_ASSERT_GREATER_THAN(0, batches + behind);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_at_the_beginning_all_is_new_and_then_nothing);
	RUN_TEST(test_what_changed_is_given_by_its_index_and_the_row_is_new);
	RUN_TEST(test_a_signal_that_changed_often_stands_once_in_a_batch);
	RUN_TEST(test_what_has_no_room_in_the_batch_comes_with_the_next);
	RUN_TEST(test_two_cursors_of_a_handle_know_nothing_of_each_other);
	RUN_TEST(test_the_numbers_of_changes_may_wrap);
	RUN_TEST(test_who_fell_behind_the_ring_is_told_so_once);
	RUN_TEST(test_a_cursor_that_was_left_alone_for_long_is_no_longer_believed);
	RUN_TEST(test_a_record_that_is_none_of_the_image_is_passed_over);
	RUN_TEST(test_the_time_is_over_when_nothing_changes);
	RUN_TEST(test_a_sleeper_wakes_for_a_change);
	RUN_TEST(test_an_owsd_that_was_killed_changes_all_once_and_its_return_too);
	RUN_TEST(test_an_owsd_that_ended_changes_all_and_the_next_one_is_awaited);
	RUN_TEST(test_a_reload_is_told_until_the_handle_is_opened_again);
	RUN_TEST(test_errno_stays_as_it_was);
	RUN_TEST(test_beside_a_busy_writer_nothing_is_missed_or_made_up);
	return UNITY_END();
}
