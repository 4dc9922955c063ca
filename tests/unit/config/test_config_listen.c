/* SPDX-License-Identifier: MIT */
/* Tests of the addresses to listen at and of ranges of peers. */
#include <arpa/inet.h>
#include <errno.h>
#include <netinet/in.h>
#include <stdlib.h>
#include <string.h>
#include <unity.h>

#include "src/config/read/listen.h"

static struct listen_address addresses[2];
static const char *why;

void setUp(void)
{
	why = "";
}

void tearDown(void)
{
}

static int parse(const char *text)
{
	return listen_parse(text, strlen(text), addresses, &why);
}

static const char *printed(int i)
{
	static char text[LISTEN_TEXT_MAX];

	listen_print(&addresses[i], text);
	return text;
}

static void test_a_bare_port_and_localhost_are_both_loopback_addresses(void)
{
	static const char *const texts[] = {"4304", "localhost:4304", "localhost"};

	for (size_t i = 0; i < sizeof(texts) / sizeof(texts[0]); i++) {
		TEST_ASSERT_EQUAL_INT(2, parse(texts[i]));
		TEST_ASSERT_EQUAL_STRING("127.0.0.1:4304", printed(0));
		TEST_ASSERT_EQUAL_STRING("[::1]:4304", printed(1));
		TEST_ASSERT_TRUE(listen_is_loopback(&addresses[0]));
		TEST_ASSERT_TRUE(listen_is_loopback(&addresses[1]));
	}
}

static void test_a_port_that_is_none_is_told_as_one(void)
{
	TEST_ASSERT_EQUAL_INT(-EINVAL, parse("99999"));
	TEST_ASSERT_EQUAL_STRING("expected a port from 0 to 65535", why);
	TEST_ASSERT_EQUAL_INT(-EINVAL, parse(""));
	TEST_ASSERT_EQUAL_STRING("expected PORT, HOST:PORT or [IPv6]:PORT", why);
}

static void test_a_network_is_served_by_its_address_only(void)
{
	static const char *const texts[] = {"0.0.0.0:4304", "192.168.1.5:5000", "[::]:4304",
	                                    "[fd00::1]:80"};

	for (size_t i = 0; i < sizeof(texts) / sizeof(texts[0]); i++) {
		TEST_ASSERT_EQUAL_INT(1, parse(texts[i]));
		TEST_ASSERT_EQUAL_STRING(texts[i], printed(0));
		TEST_ASSERT_FALSE(listen_is_loopback(&addresses[0]));
	}
	TEST_ASSERT_EQUAL_INT(1, parse("127.1.2.3:1"));
	TEST_ASSERT_TRUE(listen_is_loopback(&addresses[0]));
}

static void test_what_is_no_address_is_refused_with_a_reason(void)
{
	static const char *const texts[] = {
		"",
		":",
		":4304",
		"70000",
		"here:4304",
		"1.2.3.4:",
		"1.2.3.4:x",
		"1.2.3.4:65536",
		"::1:4304",
		"[::1]4304",
		"[::1",
		"[1.2.3.4]:4304",
		"1.2.3:4304",
		"-1",
		"4304 ",
		"[]:1",
		"1.2.3.4.5.6.7.8.9.10.11.12.13.14.15.16.17.18.19.20.21:4304",
	};

	for (size_t i = 0; i < sizeof(texts) / sizeof(texts[0]); i++) {
		TEST_ASSERT_EQUAL_INT_MESSAGE(-EINVAL, parse(texts[i]), texts[i]);
		TEST_ASSERT_NOT_EQUAL('\0', *why);
	}
}

static bool allows(const char *range, const char *peer)
{
	struct listen_peers peers;
	bool is_v6 = strchr(peer, ':');
	uint8_t bytes[16];

	TEST_ASSERT_EQUAL_INT(0, listen_peers_parse(range, strlen(range), &peers, &why));
	TEST_ASSERT_EQUAL_INT(1, inet_pton(is_v6 ? AF_INET6 : AF_INET, peer, bytes));
	return listen_peers_have(&peers, 1, is_v6, bytes);
}

static void test_ranges_have_the_peers_inside_and_no_others(void)
{
	TEST_ASSERT_TRUE(allows("192.168.1.0/24", "192.168.1.255"));
	TEST_ASSERT_FALSE(allows("192.168.1.0/24", "192.168.2.0"));
	TEST_ASSERT_TRUE(allows("10.0.0.7", "10.0.0.7"));
	TEST_ASSERT_FALSE(allows("10.0.0.7", "10.0.0.6"));
	TEST_ASSERT_TRUE(allows("10.128.0.0/9", "10.255.0.1"));
	TEST_ASSERT_FALSE(allows("10.128.0.0/9", "10.127.0.1"));
	TEST_ASSERT_TRUE(allows("0.0.0.0/0", "1.2.3.4"));
	TEST_ASSERT_FALSE(allows("0.0.0.0/0", "fd00::1"));
	TEST_ASSERT_TRUE(allows("fd00::/8", "fdff::1"));
	TEST_ASSERT_FALSE(allows("fd00::/8", "fe00::1"));
	TEST_ASSERT_TRUE(allows("192.168.1.0/24", "::ffff:192.168.1.9"));
	TEST_ASSERT_TRUE(allows("::ffff:192.168.1.0/120", "192.168.1.9"));
	TEST_ASSERT_TRUE(allows("::ffff:10.0.0.7", "::ffff:10.0.0.7"));
	TEST_ASSERT_FALSE(allows("::ffff:10.0.0.7", "10.0.0.8"));
	TEST_ASSERT_FALSE(allows("::ffff:10.0.0.0/104", "11.0.0.8"));
}

static void test_nothing_behind_the_text_is_looked_at(void)
{
	char text[] = {'4', '3', '0', '4', '4', '3'}, *copy = malloc(sizeof(text));

	TEST_ASSERT_NOT_NULL(copy);
	memcpy(copy, text, sizeof(text));
	TEST_ASSERT_EQUAL_INT(-EINVAL, listen_parse(copy, sizeof(text), addresses, &why));
	TEST_ASSERT_EQUAL_INT(2, listen_parse(copy, 4, addresses, &why));
	TEST_ASSERT_EQUAL_STRING("127.0.0.1:4304", printed(0));
	free(copy);
}

static void test_ranges_that_cannot_be_are_refused(void)
{
	static const char *const texts[] = {"",   "10.0.0.0/33", "10.0.0.0/",  "fd00::/129",
	                                    "/8", "name",        "10.0.0.0/-1"};
	struct listen_peers peers;

	for (size_t i = 0; i < sizeof(texts) / sizeof(texts[0]); i++)
		TEST_ASSERT_EQUAL_INT_MESSAGE(
			-EINVAL, listen_peers_parse(texts[i], strlen(texts[i]), &peers, &why),
			texts[i]);
}

/* What a compiler leaves between the members is not compared: a reload would open all anew. */
static void test_the_same_address_is_the_same_whatever_lies_between_its_members(void)
{
	struct listen_address a[2], b[2];
	struct listen_peers p, q;

	memset(a, 0x55, sizeof(a));
	memset(b, 0xaa, sizeof(b));
	memset(&p, 0x55, sizeof(p));
	memset(&q, 0xaa, sizeof(q));
	TEST_ASSERT_EQUAL_INT(1, listen_parse("10.1.2.3:4304", 13, a, &why));
	TEST_ASSERT_EQUAL_INT(1, listen_parse("10.1.2.3:4304", 13, b, &why));
	TEST_ASSERT_EQUAL_INT(0, listen_peers_parse("10.1.0.0/16", 11, &p, &why));
	TEST_ASSERT_EQUAL_INT(0, listen_peers_parse("10.1.0.0/16", 11, &q, &why));
	TEST_ASSERT_TRUE(listen_same(a, b));
	TEST_ASSERT_TRUE(listen_same_peers(&p, &q));
	b->port++;
	q.bits--;
	TEST_ASSERT_FALSE(listen_same(a, b));
	TEST_ASSERT_FALSE(listen_same_peers(&p, &q));
	*b = *a;
	q = p;
	b->bytes[3]++;
	q.bytes[1]++;
	TEST_ASSERT_FALSE(listen_same(a, b));
	TEST_ASSERT_FALSE(listen_same_peers(&p, &q));
}

static void test_an_address_of_a_socket_is_the_one_that_was_made_of_it(void)
{
	struct listen_address v4 = {.bytes = {192, 0, 2, 7}, .port = 4304},
			      v6 = {.is_v6 = true, .bytes = {0x20, 1, [15] = 9}, .port = 80}, got;
	struct sockaddr_storage at;
	struct sockaddr_in6 mapped = {.sin6_family = AF_INET6};
	char text[LISTEN_TEXT_MAX];

	listen_sockaddr(&v4, &at);
	TEST_ASSERT_TRUE(listen_of((struct sockaddr *)&at, &got) && listen_same(&v4, &got));
	listen_print_host(&got, text);
	TEST_ASSERT_EQUAL_STRING("192.0.2.7", text);
	listen_sockaddr(&v6, &at);
	TEST_ASSERT_TRUE(listen_of((struct sockaddr *)&at, &got) && listen_same(&v6, &got));
	listen_print(&got, text);
	TEST_ASSERT_EQUAL_STRING("[2001::9]:80", text);
	/* ::ffff:192.0.2.7 */
	memcpy(&mapped.sin6_addr, (const uint8_t[16]){[10] = 255, 255, 192, 0, 2, 7}, 16);
	mapped.sin6_port = htons(4304);
	TEST_ASSERT_TRUE(listen_of((struct sockaddr *)&mapped, &got) && listen_same(&v4, &got));
	at.ss_family = AF_UNIX;
	TEST_ASSERT_FALSE(listen_of((struct sockaddr *)&at, &got));
}

static void test_why_an_address_is_not_served_names_it(void)
{
	static const struct listen_address at = {.bytes = {10, 0, 0, 9}, .port = 502};
	char words[LISTEN_WHY_MAX];

	listen_why(&at, -EADDRINUSE, words);
	TEST_ASSERT_EQUAL_STRING("cannot listen at 10.0.0.9:502: Address already in use", words);
	listen_why(&at, -EADDRNOTAVAIL, words);
	TEST_ASSERT_EQUAL_STRING("no interface of this machine has 10.0.0.9", words);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_the_same_address_is_the_same_whatever_lies_between_its_members);
	RUN_TEST(test_a_bare_port_and_localhost_are_both_loopback_addresses);
	RUN_TEST(test_a_port_that_is_none_is_told_as_one);
	RUN_TEST(test_a_network_is_served_by_its_address_only);
	RUN_TEST(test_what_is_no_address_is_refused_with_a_reason);
	RUN_TEST(test_ranges_have_the_peers_inside_and_no_others);
	RUN_TEST(test_nothing_behind_the_text_is_looked_at);
	RUN_TEST(test_ranges_that_cannot_be_are_refused);
	RUN_TEST(test_an_address_of_a_socket_is_the_one_that_was_made_of_it);
	RUN_TEST(test_why_an_address_is_not_served_names_it);
	return UNITY_END();
}
