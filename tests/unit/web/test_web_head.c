/* SPDX-License-Identifier: MIT */
/* Tests of the strict look at the head of a request. */
#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "unity.h"

#include "src/faces/web/head.h"

void setUp(void)
{
}

void tearDown(void)
{
}

#define HEAD "GET / HTTP/1.1\r\nHost: a\r\n"
#define POST "POST / HTTP/1.1\r\nHost: a\r\n"
#define DRAFT "POST /api/config/draft HTTP/1.1\r\nHost: a\r\n"

static int check(const char *text)
{
	const char *why;

	return head_check(text, strlen(text), &why);
}

static void test_a_proper_head_is_whole_at_its_last_byte(void)
{
	static const char head[] = HEAD "Accept: */*\r\nX-Empty:\r\nX-Tab:\ta b\t\r\n\r\nrest";
	size_t end = sizeof(head) - 1 - strlen("rest");
	const char *why;

	for (size_t len = 0; len < end; len++)
		TEST_ASSERT_EQUAL_INT(0, head_check(head, len, &why));
	TEST_ASSERT_EQUAL_INT(200, head_check(head, end, &why));
	TEST_ASSERT_EQUAL_INT(200, head_check(head, sizeof(head) - 1, &why));
}

static void test_what_is_not_by_the_letter_is_refused_with_a_reason(void)
{
	static const struct {
		int status;
		const char *text;
	} cases[] = {
		{400, "GET / HTTP/1.1\nHost: a\n\n"},
		{400, HEAD "X: a\n\r\n"},
		{400, HEAD "X: a\rb\r\n\r\n"},
		{400, HEAD "X: a\r\n b\r\n\r\n"},
		{400, HEAD "X : a\r\n\r\n"},
		{400, HEAD " X: a\r\n\r\n"},
		{400, HEAD "X\r\n\r\n"},
		{400, HEAD "X: \x7f\r\n\r\n"},
		{400, HEAD "host: b\r\n\r\n"},
		{400, HEAD "Content-Length: 1\r\n\r\n"},
		{400, "GET / HTTP/1.1\r\n\r\n"},
		{400, "GET a HTTP/1.1\r\nHost: a\r\n\r\n"},
		{505, "GET /a b HTTP/1.1\r\nHost: a\r\n\r\n"},
		{400, "GET /\\ HTTP/1.1\r\nHost: a\r\n\r\n"},
		{400, "GET /%00 HTTP/1.1\r\nHost: a\r\n\r\n"},
		{400, "GET /\r\nHost: a\r\n\r\n"},
		{400, "GET\r\n\r\n"},
		{400, " / HTTP/1.1\r\n\r\n"},
		{400, "\r\n"},
		{505, "GET / HTTP/0.9\r\nHost: a\r\n\r\n"},
		{505, "GET / HTTP/1.2\r\nHost: a\r\n\r\n"},
		{400, POST "Content-Length: 1\r\nContent-Length: 1\r\n\r\n"},
		{400, POST "Content-Length: 1, 1\r\n\r\n"},
		{400, POST "Content-Length: -1\r\n\r\n"},
		{400, POST "Content-Length: \r\n\r\n"},
		{413, POST "Content-Length: 8193\r\n\r\n"},
		{413, POST "Content-Length: 18446744073709551617\r\n\r\n"},
		{200, DRAFT "Content-Length: 1572864\r\n\r\n"},
		{413, DRAFT "Content-Length: 1572865\r\n\r\n"},
		{413, "POST /api/config/save/ HTTP/1.1\r\nHost: a\r\nContent-Length: 8193\r\n\r\n"},
		{413,
	         "POST /api/config%2fsave HTTP/1.1\r\nHost: a\r\nContent-Length: 8193\r\n\r\n"},
		{501, POST "Transfer-Encoding: chunked\r\n\r\n"},
		{501, POST "transfer-encoding:x\r\n\r\n"},
		{200, POST "Content-Length: 8192\r\n\r\n"},
		{200, POST "Content-Length: 0\r\n\r\n"},
		{200, "GET /a?b=%20&c HTTP/1.0\r\nHost: a\r\n\r\n"},
		{200, HEAD "X: \xc3\xa4\r\n\r\n"},
	};

	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		const char *why;
		int status = head_check(cases[i].text, strlen(cases[i].text), &why);

		TEST_ASSERT_EQUAL_INT_MESSAGE(cases[i].status, status, cases[i].text);
		TEST_ASSERT_TRUE_MESSAGE((*why != '\0') == (status != 200), cases[i].text);
	}
}

static void test_a_refusal_does_not_wait_for_the_end_of_the_head(void)
{
	TEST_ASSERT_EQUAL_INT(400, check("GET / HTTP/1.1\n"));
	TEST_ASSERT_EQUAL_INT(400, check(HEAD "X: a\r\n b\r\n"));
	TEST_ASSERT_EQUAL_INT(501, check(POST "Transfer-Encoding: a\r\n"));
	TEST_ASSERT_EQUAL_INT(0, check("GET / HTTP/1.1\r"));
}

static void test_a_header_that_decides_something_stands_once(void)
{
	static const char *const headers[] = {
		"Host: a",
		"Content-Length: 0",
		"Content-Type: application/json",
		"Origin: http://a",
		"Sec-Fetch-Site: none",
		"X-Owsd: 1",
		"X-Remote-User: anna",
		"X-Remote-User-Name: anna",
		"Expect: 100-continue",
		"Last-Event-ID: 1:2",
	};

	for (size_t i = 0; i < sizeof(headers) / sizeof(headers[0]); i++) {
		char text[300], other[100];
		const char *host = i ? "Host: a\r\n" : "";

		snprintf(text, sizeof(text), "POST / HTTP/1.1\r\n%s%s\r\n\r\n", host, headers[i]);
		TEST_ASSERT_EQUAL_INT_MESSAGE(200, check(text), headers[i]);
		snprintf(other, sizeof(other), "%s", headers[i]);
		for (char *c = other; *c && *c != ':'; c++)
			*c = (char)tolower((unsigned char)*c);
		snprintf(text, sizeof(text), "POST / HTTP/1.1\r\n%s%s\r\nAccept: x\r\n%s\r\n\r\n",
		         host, headers[i], other);
		TEST_ASSERT_EQUAL_INT_MESSAGE(400, check(text), headers[i]);
	}
}

static void test_a_head_has_8192_bytes_at_most(void)
{
	static char text[HEAD_MAX + 2];
	const char *why;
	size_t begin = strlen(HEAD "X: ");

	memset(text, 'a', sizeof(text));
	memcpy(text, HEAD "X: ", begin);
	memcpy(text + HEAD_MAX - 4, "\r\n\r\n", 4);
	TEST_ASSERT_EQUAL_INT(200, head_check(text, HEAD_MAX, &why));
	memset(text + HEAD_MAX - 4, 'a', 4);
	TEST_ASSERT_EQUAL_INT(0, head_check(text, HEAD_MAX - 1, &why));
	TEST_ASSERT_EQUAL_INT(431, head_check(text, HEAD_MAX, &why));
	memcpy(text + HEAD_MAX - 3, "\r\n\r\n", 4);
	TEST_ASSERT_EQUAL_INT(431, head_check(text, HEAD_MAX + 1, &why));
}

/* Each byte in place of each: never a read beyond the end, which a sanitizer sees. */
static void test_a_turned_byte_is_refused_or_understood_and_never_read_past(void)
{
	static const char head[] = POST "Content-Length: 2\r\n\r\n";
	size_t len = sizeof(head) - 1;
	const char *why;

	for (size_t i = 0; i < len; i++)
		for (int byte = 0; byte < 256; byte++) {
			char *copy = malloc(len);

			memcpy(copy, head, len);
			copy[i] = (char)byte;
			for (size_t n = 0; n <= len; n++)
				TEST_ASSERT_TRUE(head_check(copy, n, &why) <= 505);
			free(copy);
		}
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_proper_head_is_whole_at_its_last_byte);
	RUN_TEST(test_what_is_not_by_the_letter_is_refused_with_a_reason);
	RUN_TEST(test_a_refusal_does_not_wait_for_the_end_of_the_head);
	RUN_TEST(test_a_header_that_decides_something_stands_once);
	RUN_TEST(test_a_head_has_8192_bytes_at_most);
	RUN_TEST(test_a_turned_byte_is_refused_or_understood_and_never_read_past);
	return UNITY_END();
}
