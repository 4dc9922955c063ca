/* SPDX-License-Identifier: MIT */
/* Tests of names: signals, driver signals and attributes. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "src/ground/signal/attribute.h"

/* Record i + 1 has name i. */
static const char *const *names;

void setUp(void)
{
	names = NULL;
}

void tearDown(void)
{
}

static int find(void *ctx, const char *name, size_t len)
{
	TEST_ASSERT_EQUAL_PTR(&names, ctx);
	TEST_ASSERT_TRUE(len > 0);
	for (int i = 0; names[i]; i++)
		if (strlen(names[i]) == len && !memcmp(names[i], name, len))
			return i + 1;
	return -1;
}

static void expect(const char *name, int record, enum attribute attribute)
{
	enum attribute got = ATTR_COUNT;

	TEST_ASSERT_EQUAL_INT_MESSAGE(record, attribute_lookup("OWS", name, find, &names, &got),
	                              name);
	TEST_ASSERT_EQUAL_INT_MESSAGE(attribute, got, name);
}

static void expect_none(const char *name)
{
	enum attribute got;

	TEST_ASSERT_EQUAL_INT_MESSAGE(-ENOENT, attribute_lookup("OWS", name, find, &names, &got),
	                              name);
}

static const char *const rooms[] = {"room1", "room2", "a", NULL};

static void test_a_signal_is_found_with_and_without_the_prefix(void)
{
	names = rooms;
	expect("room1", 1, ATTR_VALUE);
	expect("room2", 2, ATTR_VALUE);
	expect("OWS__room1", 1, ATTR_VALUE);
	expect("OWS__a", 3, ATTR_VALUE);
}

static void test_case_prefix_and_underscores_count(void)
{
	names = rooms;
	expect_none("Room1");
	expect_none("ows__room1");
	expect_none("OWS_room1");
	expect_none("OWS___room1");
	expect_none("OWS__OWS__room1");
	expect_none("room1_age");
	expect_none("room3");
	expect_none("");
	expect_none("OWS__");
	expect_none("_Age");
	expect_none("OWS___Age");
	expect_none("room1_");
	expect_none("room1_Age_Age");
}

static void test_driver_signals_are_record_zero(void)
{
	names = rooms;
	expect("_DGNRESET", 0, ATTR_DRIVER_DGNRESET);
	expect("_TRANSACTIONS", 0, ATTR_DRIVER_TRANSACTIONS);
	expect("_RECONNECTS", 0, ATTR_DRIVER_RECONNECTS);
	expect("OWS___DGNRESET", 0, ATTR_DRIVER_DGNRESET);
	expect("OWS___TRANSACTIONS", 0, ATTR_DRIVER_TRANSACTIONS);
	expect_none("room1_RECONNECTS");
}

static void test_every_attribute_is_found_by_its_name_and_its_short_form(void)
{
	char name[64];

	names = rooms;
	for (int i = 0; i < ATTR_COUNT; i++) {
		const struct attribute_def *def = &attribute_table[i];

		TEST_ASSERT_EQUAL_CHAR('_', def->name[0]);
		TEST_ASSERT_TRUE(def->readable || def->writable);
		if (def->driver)
			continue;
		snprintf(name, sizeof(name), "room2%s", def->name);
		expect(name, 2, (enum attribute)i);
		snprintf(name, sizeof(name), "OWS__room2%s", def->name);
		expect(name, 2, (enum attribute)i);
		if (!def->brief)
			continue;
		snprintf(name, sizeof(name), "OWS__room2%s", def->brief);
		expect(name, 2, (enum attribute)i);
	}
	expect("a_RE", 3, ATTR_READ_ENABLE);
	expect("a_WE", 3, ATTR_WRITE_ENABLE);
	expect("a_WOS", 3, ATTR_WRITE_ONE_SHOT);
	expect("a_ROS", 3, ATTR_READ_ONE_SHOT);
}

static void test_the_table_has_the_rights_and_types_of_the_manual(void)
{
	TEST_ASSERT_FALSE(attribute_table[ATTR_DGNRESET].readable);
	TEST_ASSERT_FALSE(attribute_table[ATTR_READ_ONE_SHOT].readable);
	TEST_ASSERT_FALSE(attribute_table[ATTR_WRITE_ONE_SHOT].readable);
	TEST_ASSERT_FALSE(attribute_table[ATTR_DRIVER_DGNRESET].readable);
	for (int i = 0; i < ATTR_COUNT; i++) {
		bool writable = i == ATTR_VALUE || i == ATTR_DGNRESET || i == ATTR_READ_ENABLE ||
		                i == ATTR_WRITE_ENABLE || i == ATTR_READ_ONE_SHOT ||
		                i == ATTR_WRITE_ONE_SHOT || i == ATTR_DRIVER_DGNRESET;

		TEST_ASSERT_EQUAL_MESSAGE(writable, attribute_table[i].writable,
		                          attribute_table[i].name);
	}
	TEST_ASSERT_EQUAL_INT(0, attribute_table[ATTR_VALUE].type);
	TEST_ASSERT_EQUAL_INT(OWS_DOUBLE, attribute_table[ATTR_AGE].type);
	TEST_ASSERT_EQUAL_INT(OWS_DOUBLE, attribute_table[ATTR_PERIOD].type);
	TEST_ASSERT_EQUAL_INT(OWS_LARGE, attribute_table[ATTR_PEND_MAX].type);
	TEST_ASSERT_EQUAL_INT(OWS_BOOL, attribute_table[ATTR_ALARM].type);
}

static void test_a_signals_own_name_wins_over_an_attribute(void)
{
	static const char *const tricky[] = {"x", "x_Age", "OWS__x_Age_Age", NULL};

	names = tricky;
	expect("x_Age", 2, ATTR_VALUE);
	expect("OWS__x_Age", 2, ATTR_VALUE);
	expect("x_AgeMax", 1, ATTR_AGE_MAX);
	expect("x_Raw", 1, ATTR_RAW);
	expect("x_Age_Age", 2, ATTR_AGE);
	expect("OWS__x_Age_Age", 3, ATTR_VALUE);
}

static void test_a_signal_whose_name_begins_with_the_prefix_is_taken_as_a_whole_first(void)
{
	static const char *const tricky[] = {"OWS__x", "x", "OWS___DGNRESET", NULL};

	names = tricky;
	expect("OWS__x", 1, ATTR_VALUE);
	expect("x", 2, ATTR_VALUE);
	expect("OWS__OWS__x", 1, ATTR_VALUE);
	expect("OWS__x_Age", 1, ATTR_AGE);
	expect("OWS___DGNRESET", 3, ATTR_VALUE);
}

static void test_without_prefix_only_bare_names_are_found(void)
{
	enum attribute got;

	names = rooms;
	TEST_ASSERT_EQUAL_INT(1, attribute_lookup(NULL, "room1_Age", find, &names, &got));
	TEST_ASSERT_EQUAL_INT(-ENOENT, attribute_lookup("", "__room1", find, &names, &got));
	TEST_ASSERT_EQUAL_INT(1, attribute_lookup("Ows", "Ows__room1", find, &names, &got));
	TEST_ASSERT_EQUAL_INT(0, attribute_lookup("Ows", "Ows___RECONNECTS", find, &names, &got));
}

static void test_printable_names_are_accepted(void)
{
	char longest[SIGNAL_NAME_MAX + 2];

	memset(longest, 'n', sizeof(longest));
	longest[SIGNAL_NAME_MAX] = '\0';
	TEST_ASSERT_NULL(signal_name_fault("room1"));
	TEST_ASSERT_NULL(signal_name_fault("x"));
	TEST_ASSERT_NULL(signal_name_fault("_Age"));
	TEST_ASSERT_NULL(signal_name_fault("a.b-c:d[0]'\\"));
	TEST_ASSERT_NULL(signal_name_fault("K\xc3\xbc"
	                                   "che\xe2\x82\xac\xf0\x9f\x8c\xa1"));
	TEST_ASSERT_NULL(signal_name_fault(longest));
}

#define NOT_UTF8 "is not UTF-8: convert the file, as with iconv -f cp1250 -t utf-8"
static void test_a_bad_name_is_refused_with_the_reason(void)
{
	static const struct {
		const char *name, *reason;
	} bad[] = {
		{"", "is empty"},
		{".", "cannot stand in a path"},
		{"..", "cannot stand in a path"},
		{"two words", "holds a blank or an invisible character"},
		{"nb\xc2\xa0sp", "holds a blank or an invisible character"},
		{"\xef\xbb\xbf"
	         "bom",
	         "holds a blank or an invisible character"},
		{"tab\t", "holds a control character"},
		{"del\x7f", "holds a control character"},
		{"c1\xc2\x85", "holds a control character"},
		{"a/b", "holds one of / \" # { }"},
		{"a\"b", "holds one of / \" # { }"},
		{"a#b", "holds one of / \" # { }"},
		{"a{b", "holds one of / \" # { }"},
		{"a}b", "holds one of / \" # { }"},
		{"latin\xe9", NOT_UTF8},
		{"cut\xe2\x82", NOT_UTF8},
		{"over\xc0\xaf", NOT_UTF8},
		{"half\xed\xa0\x80", NOT_UTF8},
		{"high\xf4\x90\x80\x80", NOT_UTF8},
		{"_DGNRESET", "is the name of a driver signal"},
		{"_TRANSACTIONS", "is the name of a driver signal"},
		{"_RECONNECTS", "is the name of a driver signal"},
	};
	char longer[SIGNAL_NAME_MAX + 2];

	for (size_t i = 0; i < sizeof(bad) / sizeof(bad[0]); i++)
		TEST_ASSERT_EQUAL_STRING_MESSAGE(bad[i].reason, signal_name_fault(bad[i].name),
		                                 bad[i].name);
	memset(longer, 'n', sizeof(longer));
	longer[SIGNAL_NAME_MAX + 1] = '\0';
	TEST_ASSERT_EQUAL_STRING("is longer than 63 bytes", signal_name_fault(longer));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_signal_is_found_with_and_without_the_prefix);
	RUN_TEST(test_case_prefix_and_underscores_count);
	RUN_TEST(test_driver_signals_are_record_zero);
	RUN_TEST(test_every_attribute_is_found_by_its_name_and_its_short_form);
	RUN_TEST(test_the_table_has_the_rights_and_types_of_the_manual);
	RUN_TEST(test_a_signals_own_name_wins_over_an_attribute);
	RUN_TEST(test_a_signal_whose_name_begins_with_the_prefix_is_taken_as_a_whole_first);
	RUN_TEST(test_without_prefix_only_bare_names_are_found);
	RUN_TEST(test_printable_names_are_accepted);
	RUN_TEST(test_a_bad_name_is_refused_with_the_reason);
	return UNITY_END();
}
