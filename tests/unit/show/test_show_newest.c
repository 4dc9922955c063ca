/* SPDX-License-Identifier: MIT */
/* Tests of the newest value: what counts of it, why not, of when it is, whether it has changed. */
#include <errno.h>
#include <math.h>

#include "unity.h"

#include "src/faces/show/newest.h"
#include "src/ground/signal/error.h"
#include "src/ground/signal/quality.h"
#include "tests/unit/aid/instance.h"

#define S INSTANCE_S

static const struct instance_signal signals[] = {
	{"room", "/28.1/temperature", OWS_DOUBLE, false, 10 * S},
	{"title", "/28.1/type", OWS_STRING, false, 0},
	{"count", "/1D.1/counters.A", OWS_LARGE, false, 0},
};
enum { ROOM, TITLE, COUNTER, COUNT };

static struct instance in;
static struct ows *ows;
static struct face_value value;
static int64_t now_ns;

void setUp(void)
{
	instance_start(&in, "newest", signals, COUNT);
	now_ns = ows_now();
	TEST_ASSERT_EQUAL_INT(0, ows_open(in.name, OWS_READ, &ows));
}

void tearDown(void)
{
	ows_close(ows);
	instance_end(&in);
}

static void look(int signal)
{
	face_value(ows, signal, true, now_ns, &value);
}

static void test_a_good_value_has_its_number_its_text_and_no_reason(void)
{
	instance_put_double(&in, ROOM + 1, 21.5, now_ns - 7);
	instance_put_text(&in, TITLE + 1, "attic", now_ns);
	look(ROOM);
	TEST_ASSERT_TRUE(value.known && value.good && !value.lost && !value.simulated);
	TEST_ASSERT_EQUAL_DOUBLE(21.5, value.v.number);
	TEST_ASSERT_EQUAL_STRING("", value.text);
	TEST_ASSERT_EQUAL_STRING("21.5", face_value_text(&value));
	TEST_ASSERT_EQUAL_STRING("", face_value_why(&value));
	TEST_ASSERT_EQUAL_STRING("", face_value_remedy(&value));
	look(TITLE);
	TEST_ASSERT_EQUAL_STRING("attic", value.text);
	TEST_ASSERT_EQUAL_STRING("attic", face_value_text(&value));
	TEST_ASSERT_TRUE(value.good);
}

static void test_a_simulated_value_says_so(void)
{
	in.detail = OWS_DETAIL_SIMULATED;
	instance_put_double(&in, ROOM + 1, 21.5, now_ns);
	look(ROOM);
	TEST_ASSERT_TRUE(value.good && value.simulated);
}

static void test_a_value_that_is_too_old_is_known_and_not_good(void)
{
	instance_put_double(&in, ROOM + 1, 21.5, now_ns - 11 * S);
	look(ROOM);
	TEST_ASSERT_TRUE(value.known);
	TEST_ASSERT_FALSE(value.good);
	TEST_ASSERT_EQUAL_STRING(quality_cause(OWS_Q_STALE), face_value_why(&value));
	TEST_ASSERT_EQUAL_STRING(quality_remedy(OWS_Q_STALE), face_value_remedy(&value));
}

static void test_the_image_of_before_a_reload_counts_while_owsd_lives(void)
{
	instance_put_double(&in, ROOM + 1, 21.5, now_ns);
	instance_reload(&in, signals, COUNT);
	look(ROOM);
	TEST_ASSERT_TRUE(value.known && value.good);
	TEST_ASSERT_EQUAL_DOUBLE(21.5, value.v.number);
	face_value(ows, ROOM, true, now_ns + 3600 * S, &value);
	TEST_ASSERT_FALSE(value.known || value.good);
	TEST_ASSERT_EQUAL_INT(OWS_Q_NO_OWSD, value.v.quality);
}

static void test_nothing_is_good_of_an_owsd_that_is_lost(void)
{
	instance_put_double(&in, ROOM + 1, 21.5, now_ns);
	face_value(ows, ROOM, false, now_ns, &value);
	TEST_ASSERT_FALSE(value.known || value.good);
	TEST_ASSERT_EQUAL_INT(OWS_Q_NO_OWSD, value.v.quality);
	TEST_ASSERT_EQUAL_STRING(quality_cause(OWS_Q_NO_OWSD), face_value_why(&value));
	TEST_ASSERT_EQUAL_STRING(quality_remedy(OWS_Q_NO_OWSD), face_value_remedy(&value));
	TEST_ASSERT_NOT_EQUAL(0, value.v.measured_ns);
}

static void test_without_an_image_there_is_no_number(void)
{
	face_value(NULL, ROOM, true, now_ns, &value);
	TEST_ASSERT_FALSE(value.known || value.good);
	TEST_ASSERT_EQUAL_INT(OWS_Q_NO_OWSD, value.v.quality);
	TEST_ASSERT_EQUAL_INT64(0, value.v.measured_ns);
	look(COUNT);
	TEST_ASSERT_FALSE(value.known || value.good);
	TEST_ASSERT_EQUAL_INT(OWS_Q_NO_PROPERTY, value.v.quality);
}

static void test_an_error_says_more_than_its_quality(void)
{
	value = (struct face_value){.known = true, .v = {.quality = OWS_Q_DEVICE, .err = -ENODEV}};
	TEST_ASSERT_EQUAL_STRING(error_text(-ENODEV), face_value_why(&value));
	value.v.err = 0;
	TEST_ASSERT_EQUAL_STRING(quality_cause(OWS_Q_DEVICE), face_value_why(&value));
	TEST_ASSERT_EQUAL_STRING(quality_remedy(OWS_Q_DEVICE), face_value_remedy(&value));
}

static void test_a_value_counts_by_what_libows_returns(void)
{
	TEST_ASSERT_TRUE(face_value_counts(0) && face_value_counts(-ENOSPC) &&
	                 face_value_counts(-ESTALE));
	TEST_ASSERT_FALSE(face_value_counts(-EAGAIN) || face_value_counts(-ENOENT) ||
	                  face_value_counts(-EACCES));
}

static void test_the_print_is_another_when_something_else_is_shown(void)
{
	struct ows_value v = {.type = OWS_DOUBLE, .quality = OWS_Q_GOOD, .number = 1},
			 whole = {.type = OWS_LARGE,
	                          .quality = OWS_Q_GOOD,
	                          .number = 0x1p53,
	                          .integer = INT64_C(1) << 53},
			 text = {.type = OWS_STRING, .quality = OWS_Q_GOOD};
	uint64_t print = face_value_print(&v, "");

	TEST_ASSERT_NOT_EQUAL(0, print);
	v.measured_ns = v.age_ns = 7;
	TEST_ASSERT_EQUAL_UINT64(print, face_value_print(&v, ""));
	v.number = nextafter(1, 2);
	TEST_ASSERT_NOT_EQUAL(print, face_value_print(&v, ""));
	print = face_value_print(&whole, "");
	whole.integer++;
	TEST_ASSERT_NOT_EQUAL(print, face_value_print(&whole, ""));
	TEST_ASSERT_NOT_EQUAL(face_value_print(&text, "a"), face_value_print(&text, "b"));
	TEST_ASSERT_EQUAL_UINT64(face_value_print(&text, ""), face_value_print(&text, NULL));
	/* a number that is not good is not shown */
	v.quality = OWS_Q_DEVICE;
	print = face_value_print(&v, "");
	v.number = 2;
	TEST_ASSERT_EQUAL_UINT64(print, face_value_print(&v, ""));
	v.quality = OWS_Q_STALE;
	TEST_ASSERT_NOT_EQUAL(print, face_value_print(&v, ""));
}

static void test_a_value_is_of_its_measurement_and_a_bad_one_of_what_showed_it(void)
{
	struct ows_value v = {.quality = OWS_Q_GOOD, .measured_ns = 10, .tried_ns = 20};

	TEST_ASSERT_EQUAL_INT64(10, face_value_time(&v, 100));
	TEST_ASSERT_EQUAL_INT64(5, face_value_time(&v, 5));
	v.quality = OWS_Q_DEVICE;
	TEST_ASSERT_EQUAL_INT64(20, face_value_time(&v, 100));
	v.tried_ns = 10;
	TEST_ASSERT_EQUAL_INT64(100, face_value_time(&v, 100));
	v.tried_ns = 20;
	v.quality = OWS_Q_STALE;
	TEST_ASSERT_EQUAL_INT64(100, face_value_time(&v, 100));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_good_value_has_its_number_its_text_and_no_reason);
	RUN_TEST(test_a_simulated_value_says_so);
	RUN_TEST(test_a_value_that_is_too_old_is_known_and_not_good);
	RUN_TEST(test_the_image_of_before_a_reload_counts_while_owsd_lives);
	RUN_TEST(test_nothing_is_good_of_an_owsd_that_is_lost);
	RUN_TEST(test_without_an_image_there_is_no_number);
	RUN_TEST(test_an_error_says_more_than_its_quality);
	RUN_TEST(test_a_value_counts_by_what_libows_returns);
	RUN_TEST(test_the_print_is_another_when_something_else_is_shown);
	RUN_TEST(test_a_value_is_of_its_measurement_and_a_bad_one_of_what_showed_it);
	return UNITY_END();
}
