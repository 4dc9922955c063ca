/* SPDX-License-Identifier: MIT */
/* Tests of what is sent of a signal, and when. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "src/faces/influx/points.h"
#include "src/ground/signal/value.h"
#include "tests/unit/aid/instance.h"

#define S INSTANCE_S
#define LINE(property) "ows,identity=/28.1/" property ",instance=OWS,signal="

static const struct instance_signal signals[] = {
	{"room", "/28.1/temperature", OWS_DOUBLE, false, 0},
	{"title", "/28.1/type", OWS_STRING, false, 0},
	{"bad\\name", "/28.1/power", OWS_BOOL, false, 0},
};
enum { ROOM, TITLE, BAD, COUNT };

static struct instance in;
static struct ows *ows;
static struct points points;
static struct pending pending;
static char batch[BATCH_BYTES + 1];
static int64_t now_ns;

void setUp(void)
{
	instance_start(&in, "influx", signals, COUNT);
	now_ns = ows_now();
	TEST_ASSERT_EQUAL_INT(0, ows_open(in.name, OWS_READ, &ows));
	TEST_ASSERT_EQUAL_INT(0, points_make(&points, ows, "ows", "OWS", &pending, now_ns));
	pending = (struct pending){0};
}

void tearDown(void)
{
	points_free(&points);
	pending_free(&pending);
	ows_close(ows);
	instance_end(&in);
}

/* What waits, with times since `from`. */
static const char *waits(int64_t from_ns)
{
	unsigned lines;

	batch[pending_copy(&pending, -from_ns, BATCH_BYTES, batch, &lines)] = '\0';
	pending_remove(&pending, UINT64_MAX);
	return batch;
}

static const char *changes(int signal)
{
	points_changes(&points, ows, &pending, signal < 0 ? NULL : &signal, 1, now_ns);
	return waits(now_ns);
}

static void test_a_value_is_sent_once_with_the_time_of_its_measurement(void)
{
	instance_put_double(&in, ROOM + 1, 21.5, now_ns - 7);
	instance_put_text(&in, TITLE + 1, "a \"b\"", now_ns - 5);
	TEST_ASSERT_EQUAL_STRING(LINE("temperature") "room value=21.5,quality=192i -7\n" LINE(
					 "type") "title text=\"a \\\"b\\\"\",quality=192i -5\n",
	                         changes(-1));
	TEST_ASSERT_EQUAL_STRING("", changes(-1));
	instance_put_double(&in, ROOM + 1, 21.5, now_ns - 3);
	TEST_ASSERT_EQUAL_STRING("", changes(ROOM));
	instance_put_double(&in, ROOM + 1, 22, now_ns - 2);
	TEST_ASSERT_EQUAL_STRING(LINE("temperature") "room value=22,quality=192i -2\n",
	                         changes(ROOM));
	TEST_ASSERT_EQUAL_STRING("", changes(COUNT));
	TEST_ASSERT_EQUAL_INT(1, points.left_out);
}

static void test_what_is_not_good_has_its_quality_alone(void)
{
	struct ows_value v = {.type = OWS_DOUBLE, .number = 85, .quality = OWS_Q_SENSOR};
	char fields[64];

	TEST_ASSERT_EQUAL_STRING(
		LINE("temperature") "room quality=0i 0\n" LINE("type") "title quality=0i 0\n",
		changes(-1));
	points_fields(&v, "", fields, sizeof(fields));
	TEST_ASSERT_EQUAL_STRING("quality=16i", fields);
	v.quality = OWS_Q_GOOD;
	v.number = NAN;
	points_fields(&v, "", fields, sizeof(fields));
	TEST_ASSERT_EQUAL_STRING("quality=192i", fields);
	v.type = OWS_STRING;
	points_fields(&v, "a\nb", fields, sizeof(fields));
	TEST_ASSERT_EQUAL_STRING("quality=192i", fields);
}

static void test_what_does_not_change_is_repeated_after_ten_minutes(void)
{
	int64_t begun_ns = now_ns;

	instance_put_double(&in, ROOM + 1, 21.5, now_ns - 7);
	changes(-1);
	now_ns += POINTS_REPEAT_NS - 1;
	instance_beat(&in, now_ns, 1);
	points_repeat(&points, ows, &pending, now_ns);
	TEST_ASSERT_EQUAL_STRING("", waits(now_ns));
	now_ns++;
	points_repeat(&points, ows, &pending, now_ns);
	/* a measurement may be under way that is older than now */
	TEST_ASSERT_NOT_NULL(strstr(waits(now_ns), "room value=21.5,quality=192i -60000000000\n"));
	points_repeat(&points, ows, &pending, now_ns);
	TEST_ASSERT_EQUAL_STRING("", waits(now_ns));
	now_ns = begun_ns + 2 * POINTS_REPEAT_NS;
	instance_beat(&in, now_ns, 2);
	instance_put_double(&in, ROOM + 1, 21.5, now_ns - S);
	points_repeat(&points, ows, &pending, now_ns);
	TEST_ASSERT_NOT_NULL(strstr(waits(now_ns), "room value=21.5,quality=192i -1000000000\n"));
}

static void test_a_lost_owsd_makes_each_signal_bad_once(void)
{
	points_lost(&points, &pending, now_ns);
	TEST_ASSERT_EQUAL_STRING("", waits(now_ns)); /* nothing was sent */
	instance_put_double(&in, ROOM + 1, 21.5, now_ns);
	changes(-1);
	points_lost(&points, &pending, now_ns + 5);
	TEST_ASSERT_EQUAL_STRING(
		LINE("temperature") "room quality=26i 5\n" LINE("type") "title quality=26i 5\n",
		waits(now_ns));
	points_lost(&points, &pending, now_ns + 6);
	TEST_ASSERT_EQUAL_STRING("", waits(now_ns));
	/* known again since now, though measured before: else the lost one would be the newest */
	TEST_ASSERT_EQUAL_STRING(LINE("temperature") "room value=21.5,quality=192i 6\n" LINE(
					 "type") "title quality=0i 6\n",
	                         changes(-1));
	/* nor does a time go back over a new image */
	TEST_ASSERT_EQUAL_INT(0, points_make(&points, ows, "ows", "OWS", &pending, now_ns));
	points_lost(&points, &pending, now_ns + 7);
	TEST_ASSERT_EQUAL_STRING("", waits(now_ns));
	TEST_ASSERT_EQUAL_STRING(LINE("temperature") "room value=21.5,quality=192i 7\n" LINE(
					 "type") "title quality=0i 7\n",
	                         changes(-1));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_value_is_sent_once_with_the_time_of_its_measurement);
	RUN_TEST(test_what_is_not_good_has_its_quality_alone);
	RUN_TEST(test_what_does_not_change_is_repeated_after_ten_minutes);
	RUN_TEST(test_a_lost_owsd_makes_each_signal_bad_once);
	return UNITY_END();
}
