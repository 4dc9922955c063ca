/* SPDX-License-Identifier: MIT */
/* Tests of the names that a browser may know this machine by. */
#include "unity.h"

#include "src/web/origin.h"

void setUp(void)
{
}

void tearDown(void)
{
}

static bool is_ours(const char *host)
{
	return origin_host(host, "192.168.1.5", "Pi.home.example", "house.example, other");
}

static void test_names_and_addresses_of_this_machine_are_known(void)
{
	static const char *const ours[] = {
		"localhost",
		"LOCALHOST:8080",
		"127.0.0.1",
		"127.1.2.3:80",
		"[::1]",
		"[::1]:8080",
		"192.168.1.5",
		"192.168.1.5:8080",
		"pi",
		"pi:8080",
		"pi.local",
		"pi.home.example",
		"pi.home.example.",
		"house.example",
		"HOUSE.example:1",
		"other",
	};

	for (size_t i = 0; i < sizeof(ours) / sizeof(ours[0]); i++)
		TEST_ASSERT_TRUE_MESSAGE(is_ours(ours[i]), ours[i]);
}

static void test_all_others_are_not(void)
{
	static const char *const others[] = {
		"",
		"evil.example",
		"localhost.evil.example",
		"192.168.1.6",
		"[::2]",
		"::1",
		"[::1",
		"[::1]x",
		"localhost:x",
		"localhost:80:80",
		"pi.evil",
		"p",
		"house",
		"example",
		"127.0.0.1.nip.io",
		"house.example, other",
		"[localhost]:80",
		"0.0.0.0",
		":80",
	};

	for (size_t i = 0; i < sizeof(others) / sizeof(others[0]); i++)
		TEST_ASSERT_FALSE_MESSAGE(is_ours(others[i]), others[i]);
	TEST_ASSERT_FALSE(origin_host("x", "", "", NULL));
	TEST_ASSERT_FALSE(origin_host(".local", "", "", NULL));
}

static void test_a_page_is_of_the_same_origin_if_its_host_and_port_are(void)
{
	TEST_ASSERT_TRUE(origin_same("http://a:80", "a:80"));
	TEST_ASSERT_TRUE(origin_same("https://A", "a"));
	TEST_ASSERT_FALSE(origin_same("http://a", "a:80"));
	TEST_ASSERT_FALSE(origin_same("http://a.b", "a"));
	TEST_ASSERT_FALSE(origin_same("null", "null"));
	TEST_ASSERT_FALSE(origin_same("ftp://a", "a"));
	TEST_ASSERT_FALSE(origin_same("", ""));
	TEST_ASSERT_FALSE(origin_same("http:x://a", "a"));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_names_and_addresses_of_this_machine_are_known);
	RUN_TEST(test_all_others_are_not);
	RUN_TEST(test_a_page_is_of_the_same_origin_if_its_host_and_port_are);
	return UNITY_END();
}
