/* SPDX-License-Identifier: MIT */
/* Tests of the POST of faces with libcurl: what a server on loopback gets, and one that is away. */
#include <netinet/in.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "unity.h"

#include "hal/base/time.h"
#include "src/faces/kit/post.h"
#include "src/public/ows.h"

static struct post *post;
static int listener;
static char url[64];

static void watch(void *ctx, int fd, short events)
{
	(void)ctx, (void)fd, (void)events;
}

void setUp(void)
{
	struct sockaddr_in at = {.sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
	socklen_t len = sizeof(at);

	listener = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
	TEST_ASSERT_EQUAL_INT(0, bind(listener, (struct sockaddr *)&at, len));
	TEST_ASSERT_EQUAL_INT(0, listen(listener, 1));
	TEST_ASSERT_EQUAL_INT(0, getsockname(listener, (struct sockaddr *)&at, &len));
	snprintf(url, sizeof(url), "http://127.0.0.1:%u/x", ntohs(at.sin_port));
	post = post_open(watch, NULL);
	TEST_ASSERT_NOT_NULL(post);
}

void tearDown(void)
{
	post_close(post);
	if (listener >= 0)
		close(listener);
}

static const struct post_what *what(void)
{
	static struct post_what one = {.type = "application/json",
	                               .scheme = "Bearer",
	                               .token = "abc",
	                               .data = "{}",
	                               .len = 2};

	one.url = url;
	return &one;
}

static void test_a_server_gets_headers_and_data_and_its_answer_is_kept(void)
{
	static const char answer[] = "HTTP/1.1 400 Bad\r\nContent-Length: 9\r\n\r\nno\x1b good\n";
	struct post_result result = {0};
	char got[1024] = "";
	ssize_t len = 0;
	int fd;

	TEST_ASSERT_EQUAL_INT(0, post_begin(post, what()));
	TEST_ASSERT_TRUE(post_is_busy(post));
	/* it connects, and writes what is short in one piece */
	TEST_ASSERT_FALSE(post_wait(post, ows_now() + 200 * NS_PER_MS, &result));
	fd = accept(listener, NULL, NULL);
	TEST_ASSERT_GREATER_OR_EQUAL_INT(0, fd);
	while (!strstr(got, "{}") && len < (ssize_t)sizeof(got) - 1) {
		ssize_t n;

		post_wait(post, ows_now() + 50 * NS_PER_MS, &result);
		n = recv(fd, got + len, sizeof(got) - 1 - (size_t)len, MSG_DONTWAIT);
		TEST_ASSERT_NOT_EQUAL_INT(0, n);
		len += n > 0 ? n : 0;
		got[len] = '\0';
	}
	TEST_ASSERT_EQUAL_STRING_LEN("POST /x HTTP/1.1\r\n", got, 18);
	TEST_ASSERT_NOT_NULL(strstr(got, "\r\nContent-Type: application/json\r\n"));
	TEST_ASSERT_NOT_NULL(strstr(got, "\r\nAuthorization: Bearer abc\r\n"));
	TEST_ASSERT_NULL(strstr(got, "Expect"));
	TEST_ASSERT_EQUAL_INT(sizeof(answer) - 1, send(fd, answer, sizeof(answer) - 1, 0));
	TEST_ASSERT_TRUE(post_wait(post, ows_now() + 20 * NS_PER_S, &result));
	TEST_ASSERT_EQUAL_INT(400, result.status);
	TEST_ASSERT_EQUAL_STRING("HTTP 400: no? good", result.words);
	TEST_ASSERT_FALSE(post_is_busy(post));
	close(fd);
}

static void test_a_server_that_is_not_there_is_no_answer(void)
{
	struct post_result result = {0};

	close(listener);
	listener = -1;
	TEST_ASSERT_EQUAL_INT(0, post_begin(post, what()));
	TEST_ASSERT_TRUE(post_wait(post, ows_now() + 20 * NS_PER_S, &result));
	TEST_ASSERT_EQUAL_INT(0, result.status);
	TEST_ASSERT_NOT_EQUAL_INT(0, strlen(result.words));
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_server_gets_headers_and_data_and_its_answer_is_kept);
	RUN_TEST(test_a_server_that_is_not_there_is_no_answer);
	return UNITY_END();
}
