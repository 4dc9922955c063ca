/* SPDX-License-Identifier: MIT */
/* Who did something: the words, and that threads ask for them at the same time. */
#include <pthread.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include "unity.h"

#include "src/faces/show/actor.h"

#define TIMES 3000

static const struct ows_by own = {0}, root = {.serial = 1, .pid = 4711, .name = "plc"},
			   nobody = {.serial = 1, .uid = 4000000123, .person = "Bert"};

void setUp(void)
{
}

void tearDown(void)
{
}

static void test_a_user_without_a_name_is_a_number_and_owsd_is_none(void)
{
	char text[ACTOR_LINE];

	TEST_ASSERT_EQUAL_STRING("-", actor_user(&own, text));
	TEST_ASSERT_EQUAL_STRING("root", actor_user(&root, text));
	TEST_ASSERT_EQUAL_STRING("4000000123", actor_user(&nobody, text));
	TEST_ASSERT_EQUAL_STRING("owsd", actor_line(&own, text));
	TEST_ASSERT_EQUAL_STRING("plc[4711] (user root)", actor_line(&root, text));
	TEST_ASSERT_EQUAL_STRING("? (user 4000000123) for Bert", actor_line(&nobody, text));
}

/* The user that the first answer names, each time? */
static void *ask(void *arg)
{
	const struct ows_by who = {.serial = 1, .uid = *(const uint32_t *)arg};
	char first[ACTOR_TEXT], text[ACTOR_TEXT];
	static bool wrong = true;

	actor_user(&who, first);
	for (int i = 0; i < TIMES; i++)
		if (strcmp(actor_user(&who, text), first) != 0)
			return &wrong;
	return NULL;
}

static void test_each_thread_gets_the_user_that_it_asks_for(void)
{
	uint32_t users[] = {0, 1};
	pthread_t threads[2];
	void *wrong;

	for (int i = 0; i < 2; i++)
		TEST_ASSERT_EQUAL_INT(0, pthread_create(&threads[i], NULL, ask, &users[i]));
	for (int i = 0; i < 2; i++) {
		TEST_ASSERT_EQUAL_INT(0, pthread_join(threads[i], &wrong));
		TEST_ASSERT_NULL_MESSAGE(wrong, "the user that the other thread asked for");
	}
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_user_without_a_name_is_a_number_and_owsd_is_none);
	RUN_TEST(test_each_thread_gets_the_user_that_it_asks_for);
	return UNITY_END();
}
