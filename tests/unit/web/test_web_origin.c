/* SPDX-License-Identifier: MIT */
/* Tests of the names that a browser may know this machine by. */
#include <stdio.h>

#include "unity.h"

#include "src/faces/web/origin.h"

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

static void test_what_a_page_of_another_origin_has_a_browser_send_is_foreign(void)
{
	static const struct {
		const char *host, *origin, *site;
		bool foreign;
	} cases[] = {
		/* no browser */
		{"a", NULL, NULL, false},
		{NULL, NULL, NULL, false},
		/* the page itself, and an address that somebody entered */
		{"a", NULL, "same-origin", false},
		{"a", NULL, "none", false},
		{"a:80", "http://a:80", "same-origin", false},
		{"a:80", "http://a:80", NULL, false},
		{"a", "https://A", NULL, false},
		/* another one, with Origin */
		{"a", "http://b", NULL, true},
		{"a:80", "http://a", NULL, true},
		{"a", "http://a:80", NULL, true},
		{"a", "http://a.b", NULL, true},
		{"a", "ftp://a", NULL, true},
		{"a", "http:x://a", NULL, true},
		{"a", "a", NULL, true},
		{"null", "null", NULL, true},
		{"", "", NULL, true},
		{NULL, "http://a", NULL, true},
		/* or without, as of an image */
		{"a", NULL, "cross-site", true},
		{"a", NULL, "same-site", true},
		{"a", NULL, "", true},
		{"a", NULL, "Same-Origin", true},
		{"a", NULL, "same-origin, cross-site", true},
		/* one of the two suffices */
		{"a", "http://a", "cross-site", true},
		{"a", "http://b", "same-origin", true},
		{"a", "http://b", "none", true},
	};

	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		char what[100];

		snprintf(what, sizeof(what), "Host: %s, Origin: %s, Sec-Fetch-Site: %s",
		         cases[i].host ? cases[i].host : "-",
		         cases[i].origin ? cases[i].origin : "-",
		         cases[i].site ? cases[i].site : "-");
		TEST_ASSERT_EQUAL_MESSAGE(
			cases[i].foreign,
			origin_foreign(cases[i].host, cases[i].origin, cases[i].site), what);
	}
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_names_and_addresses_of_this_machine_are_known);
	RUN_TEST(test_all_others_are_not);
	RUN_TEST(test_what_a_page_of_another_origin_has_a_browser_send_is_foreign);
	return UNITY_END();
}
