/* SPDX-License-Identifier: MIT */
/* Tests of the names and patterns that owsctl takes. */
#include <errno.h>
#include <string.h>

#include "unity.h"

#include "src/faces/show/names.h"
#include "src/ground/text/distance.h"
#include "tests/unit/aid/instance.h"

static const struct instance_signal signals[] = {
	{"room1", "/28.1/temperature", OWS_DOUBLE, false, 0},
	{"relay_Age", "/28.2/temperature", OWS_DOUBLE, false, 0},
	{"relay", "/29.1/PIO.0", OWS_BOOL, true, 0},
};
static struct instance in;
static struct ows *h;

void setUp(void)
{
	instance_start(&in, "names", signals, 3);
	TEST_ASSERT_EQUAL(0, ows_open(in.name, OWS_READ, &h));
}

void tearDown(void)
{
	ows_close(h);
	instance_end(&in);
}

static enum attribute attribute;
static int signal_found;

static int lookup(const char *name)
{
	return names_lookup(h, "OWS", name, &signal_found, &attribute);
}

static void test_a_name_is_a_signal_with_and_without_prefix(void)
{
	TEST_ASSERT_EQUAL(0, lookup("relay"));
	TEST_ASSERT_EQUAL(2, signal_found);
	TEST_ASSERT_EQUAL(ATTR_VALUE, attribute);
	TEST_ASSERT_EQUAL(0, lookup("OWS__room1"));
	TEST_ASSERT_EQUAL(0, signal_found);
}

static void test_a_name_may_be_an_attribute_or_a_driver_signal(void)
{
	TEST_ASSERT_EQUAL(0, lookup("room1_WOS"));
	TEST_ASSERT_EQUAL(ATTR_WRITE_ONE_SHOT, attribute);
	TEST_ASSERT_EQUAL(0, lookup("OWS___DGNRESET"));
	TEST_ASSERT_EQUAL(-1, signal_found);
	TEST_ASSERT_EQUAL(ATTR_DRIVER_DGNRESET, attribute);
}

static void test_a_signal_wins_over_an_attribute(void)
{
	TEST_ASSERT_EQUAL(0, lookup("relay_Age"));
	TEST_ASSERT_EQUAL(1, signal_found);
	TEST_ASSERT_EQUAL(ATTR_VALUE, attribute);
}

static void test_an_unknown_name_is_told(void)
{
	TEST_ASSERT_EQUAL(-ENOENT, lookup("room2"));
	TEST_ASSERT_EQUAL(-ENOENT, lookup(""));
}

static char pattern_a[] = "room*", pattern_b[] = "re??y";

static void test_patterns_select_names(void)
{
	char *patterns[] = {pattern_a, pattern_b};

	TEST_ASSERT_TRUE(names_match("room1", patterns, 2));
	TEST_ASSERT_TRUE(names_match("relay", patterns, 2));
	TEST_ASSERT_FALSE(names_match("relay2", patterns, 2));
	TEST_ASSERT_FALSE(names_match("relay", patterns, 1));
}

static void test_no_pattern_selects_all(void)
{
	TEST_ASSERT_TRUE(names_match("anything", NULL, 0));
}

static void test_the_distance_counts_mistypings(void)
{
	TEST_ASSERT_EQUAL(0, text_distance("room1", "room1"));
	TEST_ASSERT_EQUAL(1, text_distance("rom1", "room1"));
	TEST_ASSERT_EQUAL(1, text_distance("room11", "room1"));
	TEST_ASSERT_EQUAL(1, text_distance("roon1", "room1"));
	TEST_ASSERT_EQUAL(1, text_distance("romo1", "room1"));
	TEST_ASSERT_EQUAL(5, text_distance("", "room1"));
	TEST_ASSERT_EQUAL(3, text_distance("kitten", "sitting"));
}

static void test_the_distance_is_the_same_both_ways(void)
{
	static const char *const some[] = {"", "a", "room1", "relay", "relay_Age", "yaler"};

	for (size_t i = 0; i < 6; i++)
		for (size_t j = 0; j < 6; j++)
			TEST_ASSERT_EQUAL(text_distance(some[i], some[j]),
			                  text_distance(some[j], some[i]));
}

static void nearest_is(const char *expected, const char *name)
{
	char nearest[NAMES_MAX];

	TEST_ASSERT_TRUE(names_nearest(h, name, nearest));
	TEST_ASSERT_EQUAL_STRING(expected, nearest);
}

static void test_the_nearest_name_is_found(void)
{
	nearest_is("room1", "rom1");
	nearest_is("relay", "Relay");
	nearest_is("room1_ReadEnable", "room1_ReadEnabel");
	nearest_is("_TRANSACTIONS", "_TRANSACTION");
}

static void test_a_name_that_is_far_from_all_has_no_nearest(void)
{
	char nearest[NAMES_MAX];
	char big[1000];

	TEST_ASSERT_FALSE(names_nearest(h, "boiler", nearest));
	memset(big, 'x', sizeof(big) - 1);
	big[sizeof(big) - 1] = '\0';
	TEST_ASSERT_FALSE(names_nearest(h, big, nearest));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_name_is_a_signal_with_and_without_prefix);
	RUN_TEST(test_a_name_may_be_an_attribute_or_a_driver_signal);
	RUN_TEST(test_a_signal_wins_over_an_attribute);
	RUN_TEST(test_an_unknown_name_is_told);
	RUN_TEST(test_patterns_select_names);
	RUN_TEST(test_no_pattern_selects_all);
	RUN_TEST(test_the_distance_counts_mistypings);
	RUN_TEST(test_the_distance_is_the_same_both_ways);
	RUN_TEST(test_the_nearest_name_is_found);
	RUN_TEST(test_a_name_that_is_far_from_all_has_no_nearest);
	return UNITY_END();
}
