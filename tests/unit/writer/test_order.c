/* SPDX-License-Identifier: MIT */
/* Tests of the head of a request to the writer. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "src/config/read/rio.h"
#include "src/faces/writer/order.h"

#define FIRST "owsd-writer 1\n"
#define TAG "0123456789abcdef"

static struct order order;
static const char *why;

void setUp(void)
{
}

void tearDown(void)
{
}

static int parse(const char *text)
{
	return order_parse(text, strlen(text), &order, &why);
}

static void refuses(const char *text, const char *words)
{
	TEST_ASSERT_EQUAL_INT_MESSAGE(-EINVAL, parse(text), text);
	TEST_ASSERT_NOT_NULL(why);
	TEST_ASSERT_NOT_NULL_MESSAGE(strstr(why, words), why);
}

static void test_a_whole_head_has_its_length_and_all_before_has_none(void)
{
	static const char head[] = FIRST "do: replace\nbase: " TAG "\nfor: anna\nlength: 12\n\n";
	static const char text[] = FIRST "do: replace\nbase: " TAG
					 "\nfor: anna\nlength: 12\n\nOwsDrv {\n\n}\n";

	for (size_t len = 0; len < sizeof(head) - 1; len++)
		TEST_ASSERT_EQUAL_INT(0, order_parse(text, len, &order, &why));
	TEST_ASSERT_EQUAL_INT(sizeof(head) - 1, parse(text));
	TEST_ASSERT_EQUAL_INT(ORDER_REPLACE, order.kind);
	TEST_ASSERT_EQUAL_STRING(TAG, order.base);
	TEST_ASSERT_EQUAL_STRING("anna", order.person);
	TEST_ASSERT_EQUAL_size_t(12, order.length);
}

static void test_a_restore_has_a_base_and_no_length(void)
{
	TEST_ASSERT_GREATER_THAN(0, parse(FIRST "base:\ndo:restore\n\n"));
	TEST_ASSERT_EQUAL_INT(ORDER_RESTORE, order.kind);
	TEST_ASSERT_EQUAL_STRING("", order.base);
	TEST_ASSERT_EQUAL_STRING("", order.person);
	refuses(FIRST "do: restore\nbase: " TAG "\nlength: 3\n\n", "a restore has no bytes");
}

static void test_a_rename_has_a_length_and_no_base(void)
{
	TEST_ASSERT_GREATER_THAN(0, parse(FIRST "do: rename\nlength: 12\n\n"));
	TEST_ASSERT_EQUAL_INT(ORDER_RENAME, order.kind);
	TEST_ASSERT_EQUAL_size_t(12, order.length);
	refuses(FIRST "do: rename\nbase: " TAG "\nlength: 3\n\n", "a rename has none");
	refuses(FIRST "do: rename\n\n", "length: is missing");
}

static void test_another_version_is_refused_at_its_first_byte(void)
{
	refuses("G", "owsd-writer 1");
	refuses("owsd-writer 2", "owsd-writer 1");
	refuses("owsd-writer 1\r", "owsd-writer 1");
	refuses("owsd-writer 12", "owsd-writer 1");
	refuses("\n", "owsd-writer 1");
}

static void test_what_is_missing_or_twice_is_said(void)
{
	refuses(FIRST "\n", "do: is missing");
	refuses(FIRST "do: replace\nlength: 1\n\n", "base: is missing");
	refuses(FIRST "do: replace\nbase: \n\n", "length: is missing");
	refuses(FIRST "do: replace\ndo: replace\nbase:\nlength: 1\n\n", "twice");
	refuses(FIRST "do: replace\nfile: /etc/shadow\n\n", "no such key");
	refuses(FIRST "do replace\n\n", "key: value");
	refuses(FIRST " do: replace\n\n", "no such key");
}

static void test_values_that_cannot_be_are_refused(void)
{
	char text[200];

	refuses(FIRST "do: remove\n\n", "replace, restore or rename");
	refuses(FIRST "base: 0123\n\n", "16 digits");
	refuses(FIRST "base: 0123456789ABCDEF\n\n", "small letters");
	refuses(FIRST "base: 0123456789abcdefa\n\n", "16 digits");
	refuses(FIRST "length: -1\n\n", "number of bytes");
	refuses(FIRST "length: 1 \n\n", "number of bytes");
	refuses(FIRST "length:\n\n", "number of bytes");
	refuses(FIRST "length: 99999999999999999999999999\n\n", "longer than");
	snprintf(text, sizeof(text), FIRST "do: replace\nbase:\nlength: %u\n\n", RIO_FILE_MAX);
	TEST_ASSERT_GREATER_THAN(0, parse(text));
	TEST_ASSERT_EQUAL_size_t(RIO_FILE_MAX, order.length);
	snprintf(text, sizeof(text), FIRST "length: %u\n\n", RIO_FILE_MAX + 1);
	refuses(text, "longer than");
}

static void test_a_person_is_printable_and_not_too_long(void)
{
	char text[200], name[80];

	TEST_ASSERT_GREATER_THAN(0, parse(FIRST "do:restore\nbase:\nfor: \xc5\xbd"
	                                        "an\xff\n\n"));
	TEST_ASSERT_EQUAL_STRING("\xc5\xbd"
	                         "an?",
	                         order.person);
	refuses(FIRST "for: a\tb\n\n", "control character");
	TEST_ASSERT_GREATER_THAN(0, parse(FIRST "do:restore\nbase:\nfor: x\": done by \"y\n\n"));
	TEST_ASSERT_EQUAL_STRING("x': done by 'y", order.person);
	memset(name, 'n', sizeof(name));
	name[63] = '\0';
	snprintf(text, sizeof(text), FIRST "do:restore\nbase:\nfor:%s\n\n", name);
	TEST_ASSERT_GREATER_THAN(0, parse(text));
	TEST_ASSERT_EQUAL_STRING(name, order.person);
	snprintf(text, sizeof(text), FIRST "do:restore\nbase:\nfor:%sn\n\n", name);
	refuses(text, "longer than 63");
}

static void test_a_head_without_end_is_refused_when_it_is_too_long(void)
{
	char text[ORDER_HEAD_MAX + 100];

	memset(text, 'x', sizeof(text));
	memcpy(text, FIRST, strlen(FIRST));
	TEST_ASSERT_EQUAL_INT(0, order_parse(text, ORDER_HEAD_MAX - 1, &order, &why));
	TEST_ASSERT_EQUAL_INT(-EINVAL, order_parse(text, ORDER_HEAD_MAX, &order, &why));
	memcpy(text + ORDER_HEAD_MAX, "\n\n", 2);
	TEST_ASSERT_EQUAL_INT(-EINVAL, order_parse(text, sizeof(text), &order, &why));
	TEST_ASSERT_NOT_NULL(strstr(why, "longer than 1024"));
}

static void test_a_zero_in_a_head_is_refused(void)
{
	static const char text[] = FIRST "do: restore\nbase:\nfor: a\0b\n\n";

	TEST_ASSERT_EQUAL_INT(-EINVAL, order_parse(text, sizeof(text) - 1, &order, &why));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_whole_head_has_its_length_and_all_before_has_none);
	RUN_TEST(test_a_restore_has_a_base_and_no_length);
	RUN_TEST(test_a_rename_has_a_length_and_no_base);
	RUN_TEST(test_another_version_is_refused_at_its_first_byte);
	RUN_TEST(test_what_is_missing_or_twice_is_said);
	RUN_TEST(test_values_that_cannot_be_are_refused);
	RUN_TEST(test_a_person_is_printable_and_not_too_long);
	RUN_TEST(test_a_head_without_end_is_refused_when_it_is_too_long);
	RUN_TEST(test_a_zero_in_a_head_is_refused);
	return UNITY_END();
}
