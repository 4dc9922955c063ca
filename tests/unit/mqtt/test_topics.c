/* SPDX-License-Identifier: MIT */
/* Tests of topics. */
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "src/mqtt/topics.h"

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
	char name[64], back[TOPIC_NAME], topic[TOPIC_SIZE];

	memset(name, '+', 63);
	name[63] = '\0';
	TEST_ASSERT_EQUAL_UINT(3 * 63, strlen(level(name)));
	snprintf(topic, sizeof(topic), "owsd/pi7/%s/set", level(name));
	TEST_ASSERT_TRUE(topic_is_command("owsd/pi7", topic, back));
	TEST_ASSERT_EQUAL_STRING(name, back);
}

static void test_a_command_is_that_of_one_signal(void)
{
	char name[TOPIC_NAME];

	TEST_ASSERT_TRUE(topic_is_command("owsd/pi7", "owsd/pi7/a%2Bb/set", name));
	TEST_ASSERT_EQUAL_STRING("a+b", name);
	TEST_ASSERT_TRUE(topic_is_command("owsd/pi7", "owsd/pi7/%73tate/set", name));
	TEST_ASSERT_EQUAL_STRING("state", name);
	static const char *const others[] = {
		"owsd/pi7/a",       "owsd/pi7/a/get",    "owsd/pi7//set",     "owsd/pi7/set",
		"owsd/pi8/a/set",   "owsd/pi7/a/b/set",  "owsd/pi7/a/set/",   "owsd/pi7",
		"owsd/pi7/%61/set", "owsd/pi7/%2b/set",  "owsd/pi7/%2/set",   "owsd/pi7/state/set",
		"owsd/pi7a/set",    "owsd/pi7/%00a/set", "owsd/pi7/chip/set", "",
	};

	for (size_t i = 0; i < sizeof(others) / sizeof(others[0]); i++)
		TEST_ASSERT_FALSE_MESSAGE(topic_is_command("owsd/pi7", others[i], name), others[i]);
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
	RUN_TEST(test_a_command_is_that_of_one_signal);
	RUN_TEST(test_an_id_has_what_home_assistant_takes);
	return UNITY_END();
}
