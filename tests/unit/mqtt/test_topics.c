/* SPDX-License-Identifier: MIT */
/* Tests of topics. */
#include <string.h>

#include "unity.h"

#include "src/faces/mqtt/topics.h"

void setUp(void)
{
}
void tearDown(void)
{
}

static const char *level(const char *name)
{
	static char text[TOPIC_NAME];

	topic_escape(name, text);
	return text;
}

static void test_a_name_is_a_level_and_what_a_level_cannot_have_is_escaped(void)
{
	TEST_ASSERT_EQUAL_STRING("room1", level("room1"));
	TEST_ASSERT_EQUAL_STRING("Stra\xc3\x9f"
	                         "e",
	                         level("Stra\xc3\x9f"
	                               "e"));
	TEST_ASSERT_EQUAL_STRING("a%2Bb%25c", level("a+b%c"));
	TEST_ASSERT_EQUAL_STRING("%73tate", level("state"));
	TEST_ASSERT_EQUAL_STRING("%68ealth", level("health"));
	TEST_ASSERT_EQUAL_STRING("%63hip", level("chip"));
	TEST_ASSERT_EQUAL_STRING("states", level("states"));
}

static void test_the_longest_name_has_room_whatever_is_in_it(void)
{
	char name[64];

	memset(name, '+', 63);
	name[63] = '\0';
	TEST_ASSERT_EQUAL_UINT(3 * 63, strlen(level(name)));
}

static void test_a_slug_has_what_the_conventions_take(void)
{
	char id[10];

	topic_slug("T_Kitchen 1.2", '-', id, sizeof(id));
	TEST_ASSERT_EQUAL_STRING("t-kitchen", id);
	topic_slug("a--b+\xc3\xa4", '_', id, sizeof(id));
	TEST_ASSERT_EQUAL_STRING("a_b_", id);
	topic_slug("_", '-', id, sizeof(id));
	TEST_ASSERT_EQUAL_STRING("-", id);
}

static void test_an_id_has_what_home_assistant_takes(void)
{
	char id[8];

	topic_id("28.A0+-\xc3\xa4", id, sizeof(id));
	TEST_ASSERT_EQUAL_STRING("28_A0_-", id);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_name_is_a_level_and_what_a_level_cannot_have_is_escaped);
	RUN_TEST(test_the_longest_name_has_room_whatever_is_in_it);
	RUN_TEST(test_a_slug_has_what_the_conventions_take);
	RUN_TEST(test_an_id_has_what_home_assistant_takes);
	return UNITY_END();
}
