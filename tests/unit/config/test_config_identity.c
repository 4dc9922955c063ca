/* SPDX-License-Identifier: MIT */
/* What an item is known by when its name and its device have changed. */
#include "unity.h"

#include "src/config/read/texts.h"
#include "tests/unit/aid/config_case.h"

void setUp(void)
{
	config_case_begin();
}

void tearDown(void)
{
	config_case_end();
}

/* Keys of an item of a temperature, and of others. */
#define OF(name, path, more) "Item { Name " name " Path " path " Type double " more "}"

static void expect_identities(const char *keys, const char *const *expected, unsigned count)
{
	TEST_ASSERT_EQUAL_INT(0, parse_driver(keys));
	TEST_ASSERT_EQUAL_UINT(count, config->item_count);
	for (unsigned i = 0; i < count; i++)
		TEST_ASSERT_EQUAL_STRING(expected[i], config->items[i].identity);
	config_case_end();
	config_case_begin();
}

static void test_an_item_is_its_path_unless_identity_says_otherwise(void)
{
	expect_identities(OF("a", "/uncached/bus.1/x/y", "") OF("b", "q/y", "Identity \"/x/y\""),
	                  (const char *const[]){"/bus.1/x/y", "/x/y"}, 2);
}

static void test_items_of_one_path_are_counted_in_the_order_of_the_file(void)
{
	expect_identities(OF("z", "/x/y", "") OF("a", "/x/y", "IO output") OF("m", "/q/y", "")
	                          OF("b", "/x/y", ""),
	                  (const char *const[]){"/x/y", "/x/y#2", "/q/y", "/x/y#3"}, 4);
	/* a device that was replaced, and serves elsewhere now */
	expect_identities(OF("a", "/x/y", "") OF("b", "/q/y", "Identity /x/y"),
	                  (const char *const[]){"/x/y#2", "/x/y"}, 2);
}

static void test_a_number_that_is_given_is_passed_over(void)
{
	expect_identities(OF("a", "/x/y", "") OF("b", "/x/y", "")
	                          OF("c", "/q/y", "Identity \"/x/y#2\"") OF("d", "/x/y", "")
	                                  OF("e", "/r/y", "Identity \"/x/y#4\""),
	                  (const char *const[]){"/x/y", "/x/y#3", "/x/y#2", "/x/y#5", "/x/y#4"}, 5);
}

static void test_an_identity_is_given_once_and_is_a_path(void)
{
	static const struct line cases[] = {
		{OF("a", "/x/y", "Identity /o/y") "\n" OF("b", "/q/y", "Identity /o/y"),
	         "f:3:13: error: the identity \"/o/y\" is given twice, first in line 2: give one of them another Identity\n"},
		{OF("a", "/x/y", "Identity room"),
	         "f:2:46: error: Identity \"room\": expected the path that the signal had, such "
	         "as /28.FF01/temperature\n"},
		{OF("a", "/x/y", "Identity \"/\xe9/y\""),
	         "f:2:46: error: Identity \"/?/y\": expected the path that the signal had, "
	         "such as /28.FF01/temperature\n"},
	};

	expect_errors(cases, COUNT(cases), parse_driver);
}

static void test_an_identity_is_utf8_without_control_characters(void)
{
	TEST_ASSERT_NULL(text_is_identity("/K\xc3\xbc"
	                                  "che/temperature#2"));
	TEST_ASSERT_NOT_NULL(text_is_identity("/a\nb"));
	TEST_ASSERT_NOT_NULL(text_is_identity("/a\xc3"));
	TEST_ASSERT_NOT_NULL(text_is_identity(""));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_an_item_is_its_path_unless_identity_says_otherwise);
	RUN_TEST(test_items_of_one_path_are_counted_in_the_order_of_the_file);
	RUN_TEST(test_a_number_that_is_given_is_passed_over);
	RUN_TEST(test_an_identity_is_given_once_and_is_a_path);
	RUN_TEST(test_an_identity_is_utf8_without_control_characters);
	return UNITY_END();
}
