/* SPDX-License-Identifier: MIT */
/* Tests of what a message asks for, as text and as JSON, and of the answer. */
#include <stdlib.h>
#include <string.h>

#include "unity.h"

#include "src/faces/mqtt/ask.h"

static struct ask ask;

void setUp(void)
{
	/* what was asked for before has no part in it */
	memset(&ask, 0x55, sizeof(ask));
}

void tearDown(void)
{
}

static const char *read_text(const char *text)
{
	return ask_read(&ask, text, strlen(text), false);
}

static const char *answer(const char *why)
{
	static char answered[400];
	char *text = NULL;
	struct json json;
	size_t len;

	TEST_ASSERT_TRUE(json_start(&json, &text, &len));
	ask_answer_json(&json, &ask, why);
	json_finish(&json);
	snprintf(answered, sizeof(answered), "%.*s", (int)strcspn(text, "\n"), text);
	free(text);
	return answered;
}

static void test_a_text_is_the_value_itself(void)
{
	TEST_ASSERT_NULL(read_text("21.5"));
	TEST_ASSERT_EQUAL_STRING("21.5", ask.value);
	TEST_ASSERT_EQUAL_STRING("{\"taken\":true,\"set\":\"21.5\"}", answer(NULL));
	TEST_ASSERT_EQUAL_STRING("{\"taken\":false,\"set\":\"21.5\",\"why\":\"x\"}", answer("x"));
	/* of a string a text in braces is one, too */
	TEST_ASSERT_NULL(ask_read(&ask, "{hello", 6, true));
	TEST_ASSERT_EQUAL_STRING("{hello", ask.value);
}

static void test_an_object_has_the_value_and_what_the_sender_calls_it(void)
{
	static const struct {
		const char *text, *value, *answer;
	} cases[] = {
		{"{\"v\":21.5}", "21.5", "{\"taken\":true,\"set\":\"21.5\"}"},
		{"{\"v\":true,\"id\":\"a1\"}", "true",
	         "{\"taken\":true,\"set\":\"true\",\"id\":\"a1\"}"},
		{"{\"id\":7,\"v\":\"toggle\"}", "toggle",
	         "{\"taken\":true,\"set\":\"toggle\",\"id\":7}"},
		{"{\"id\":7}", "", "{\"taken\":true,\"set\":\"\",\"id\":7}"},
		{"{\"v\":null}", "", "{\"taken\":true,\"set\":\"\"}"},
	};

	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		TEST_ASSERT_NULL(read_text(cases[i].text));
		TEST_ASSERT_EQUAL_STRING(cases[i].value, ask.value);
		TEST_ASSERT_EQUAL_STRING(cases[i].answer, answer(NULL));
	}
}

static void test_who_asks_for_no_value_is_answered_without_one(void)
{
	TEST_ASSERT_NULL(read_text("{\"id\":7}"));
	ask.value = NULL;
	TEST_ASSERT_EQUAL_STRING("{\"taken\":true,\"id\":7}", answer(NULL));
}

static void test_what_begins_as_an_object_and_is_none_is_refused(void)
{
	static char text[ASK_MOST + 2];

	TEST_ASSERT_NOT_NULL(strstr(read_text("{\"v\":"), "no JSON"));
	TEST_ASSERT_EQUAL_STRING("", ask.value);
	TEST_ASSERT_NULL(ask.id);
	TEST_ASSERT_NOT_NULL(strstr(read_text("{\"v\":{\"v\":1}}"), "no JSON"));
	memset(text, '1', ASK_MOST + 1);
	TEST_ASSERT_NOT_NULL(strstr(read_text(text), "longer than 1024"));
	TEST_ASSERT_EQUAL_STRING("", ask.value);
	text[ASK_MOST] = '\0';
	TEST_ASSERT_NULL(read_text(text));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_text_is_the_value_itself);
	RUN_TEST(test_an_object_has_the_value_and_what_the_sender_calls_it);
	RUN_TEST(test_who_asks_for_no_value_is_answered_without_one);
	RUN_TEST(test_what_begins_as_an_object_and_is_none_is_refused);
	return UNITY_END();
}
