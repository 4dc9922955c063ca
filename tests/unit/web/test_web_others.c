/* SPDX-License-Identifier: MIT */
/* Tests of the pages of other machines, with a name server that is silent. */
#include <netdb.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "unity.h"

#include "src/config/read/others.h"
#include "src/faces/web/others.h"

#define ROUNDS 10
#define PATIENCE 3000 /* of 10 ms */

static atomic_bool silent;
static atomic_uint waiting;

/* In place of the C library's. */
int getaddrinfo(const char *name, const char *service, const struct addrinfo *hints,
                struct addrinfo **found)
{
	(void)name;
	(void)service;
	(void)hints;
	*found = NULL;
	waiting++;
	while (silent)
		usleep(1000); /* pace */
	waiting--;
	return EAI_NONAME;
}

void setUp(void)
{
	silent = true;
}

void tearDown(void)
{
	silent = false;
}

static char *list_of(unsigned round)
{
	static char list[OTHERS_MAX * 60];

	list[0] = '\0';
	for (unsigned i = 0; i < OTHERS_MAX; i++)
		snprintf(list + strlen(list), sizeof(list) - strlen(list),
		         "%spi%u http://pi%u-%u.example:80/", i ? ", " : "", i, i, round);
	return list;
}

static bool says(struct others *others, const char *words)
{
	struct json json;
	char *text;
	size_t len;
	bool is;

	TEST_ASSERT_TRUE(json_start(&json, &text, &len));
	json_array(&json, "others");
	others_json(others, &json, 0);
	json_array_end(&json);
	json_finish(&json);
	is = strstr(text, words) != NULL;
	free(text);
	return is;
}

static void test_reloads_beside_a_silent_name_server_make_no_threads_without_end(void)
{
	struct others *others = NULL;

	for (unsigned round = 0; round < ROUNDS; round++) {
		others_end(others);
		others = others_begin(list_of(round));
		TEST_ASSERT_NOT_NULL(others);
		TEST_ASSERT_EQUAL_UINT(OTHERS_MAX, others_count(others));
		/* each that was begun is in the resolver soon */
		for (int i = 0; waiting < (round ? 2 : 1) * OTHERS_MAX && i < PATIENCE; i++)
			usleep(10000); /* pace */
	}
	TEST_ASSERT_EQUAL_UINT(2 * OTHERS_MAX, waiting);
	TEST_ASSERT_TRUE(says(others, "for want of a thread"));
	others_end(others);
	silent = false;
	for (int i = 0; waiting && i < PATIENCE; i++)
		usleep(10000); /* pace */
	/* the next list is asked again, once those of before have ended */
	for (int i = 0; i < PATIENCE; i++) {
		others = others_begin(list_of(ROUNDS));
		if (!says(others, "for want of a thread"))
			break;
		others_end(others);
		others = NULL;
		usleep(10000); /* pace */
	}
	TEST_ASSERT_NOT_NULL(others);
	for (int i = 0; !says(others, "no address of that name") && i < PATIENCE; i++)
		usleep(10000); /* pace */
	TEST_ASSERT_TRUE(says(others, "no address of that name"));
	others_end(others);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_reloads_beside_a_silent_name_server_make_no_threads_without_end);
	return UNITY_END();
}
