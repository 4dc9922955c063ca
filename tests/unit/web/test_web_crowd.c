/* SPDX-License-Identifier: MIT */
/* How many connections a user or an address has. */
#include <arpa/inet.h>
#include <errno.h>
#include <string.h>

#include "unity.h"

#include "src/faces/web/crowd.h"

static struct crowd crowd;

void setUp(void)
{
	memset(&crowd, 0, sizeof(crowd));
}

void tearDown(void)
{
}

static struct crowd_key address(int family, const char *text)
{
	struct sockaddr_storage at = {.ss_family = (sa_family_t)family};
	void *bytes = family == AF_INET ? (void *)&((struct sockaddr_in *)(void *)&at)->sin_addr
	                                : (void *)&((struct sockaddr_in6 *)(void *)&at)->sin6_addr;

	TEST_ASSERT_EQUAL(1, inet_pton(family, text, bytes));
	return crowd_address(&at);
}

static void test_each_has_as_many_places_as_any_other(void)
{
	struct crowd_key keys[] = {crowd_user(1000),
	                           crowd_user(1001),
	                           address(AF_INET, "10.0.0.1"),
	                           address(AF_INET, "10.0.0.2"),
	                           address(AF_INET6, "fe80::1"),
	                           address(AF_INET6, "fe80::2")};

	for (size_t k = 0; k < sizeof(keys) / sizeof(keys[0]); k++) {
		for (int i = 0; i < 64; i++)
			TEST_ASSERT_GREATER_OR_EQUAL(0, crowd_enter(&crowd, &keys[k], 64));
		TEST_ASSERT_EQUAL(-ENOSPC, crowd_enter(&crowd, &keys[k], 64));
	}
}

static void test_a_place_that_is_left_is_free_again(void)
{
	struct crowd_key user = crowd_user(1000);
	int place = crowd_enter(&crowd, &user, 2);

	TEST_ASSERT_NOT_EQUAL(place, crowd_enter(&crowd, &user, 2));
	TEST_ASSERT_EQUAL(-ENOSPC, crowd_enter(&crowd, &user, 2));
	crowd_leave(&crowd, CROWD_NOBODY);
	TEST_ASSERT_EQUAL(-ENOSPC, crowd_enter(&crowd, &user, 2));
	crowd_leave(&crowd, place);
	TEST_ASSERT_EQUAL(place, crowd_enter(&crowd, &user, 2));
}

static void test_there_are_no_more_places_than_the_crowd_has(void)
{
	for (unsigned i = 0; i < CROWD; i++) {
		struct crowd_key user = crowd_user(1000 + i);

		TEST_ASSERT_EQUAL(i, crowd_enter(&crowd, &user, 64));
	}
	TEST_ASSERT_EQUAL(-ENOSPC, crowd_enter(&crowd, &(struct crowd_key){.kind = AF_INET}, 64));
}

static void test_an_address_counts_the_same_in_both_forms(void)
{
	struct crowd_key mapped = address(AF_INET6, "::ffff:10.0.0.1");
	struct crowd_key plain = address(AF_INET, "10.0.0.1");

	TEST_ASSERT_EQUAL_MEMORY(&plain, &mapped, sizeof(plain));
}

static void test_root_counts_as_a_user_and_a_socket_has_no_address(void)
{
	struct sockaddr_storage local = {.ss_family = AF_UNIX};

	TEST_ASSERT_NOT_EQUAL(0, crowd_user(0).kind);
	TEST_ASSERT_EQUAL(0, crowd_address(&local).kind);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_each_has_as_many_places_as_any_other);
	RUN_TEST(test_a_place_that_is_left_is_free_again);
	RUN_TEST(test_there_are_no_more_places_than_the_crowd_has);
	RUN_TEST(test_an_address_counts_the_same_in_both_forms);
	RUN_TEST(test_root_counts_as_a_user_and_a_socket_has_no_address);
	return UNITY_END();
}
