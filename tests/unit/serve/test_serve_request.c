/* SPDX-License-Identifier: MIT */
/* Tests of the parser of requests of the owserver protocol. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unity.h>

#include "hal/owfs/frame.h"
#include "src/daemon/serve/request.h"

static uint8_t bytes[REQUEST_MAX + 64];
static struct request request;
static size_t length;

void setUp(void)
{
	memset(bytes, 0, sizeof(bytes));
	memset(&request, 0, sizeof(request));
}

void tearDown(void)
{
}

static size_t make(uint32_t version, int32_t payload, int32_t type, int32_t size, const char *body,
                   size_t body_len)
{
	struct frame_header h = {
		.version = version, .payload = payload, .type = type, .flags = 0x10a, .size = size};

	frame_put_header(bytes, &h);
	memcpy(bytes + FRAME_HEADER, body, body_len);
	return FRAME_HEADER + body_len;
}

static void test_a_request_is_whole_at_its_last_byte(void)
{
	size_t n = make(0, 9, FRAME_READ, 100, "/a/b/c/d", 9);

	for (size_t have = 0; have < n; have++) {
		TEST_ASSERT_EQUAL_INT(0, request_parse(bytes, have, &request, &length));
		TEST_ASSERT_EQUAL_size_t(have < FRAME_HEADER ? FRAME_HEADER : n, length);
	}
	TEST_ASSERT_EQUAL_INT(1, request_parse(bytes, n + 5, &request, &length));
	TEST_ASSERT_EQUAL_size_t(n, length);
	TEST_ASSERT_EQUAL_STRING_LEN("/a/b/c/d", request.path, request.path_len);
	TEST_ASSERT_EQUAL_UINT(8, request.path_len);
	TEST_ASSERT_EQUAL_INT(FRAME_READ, request.type);
	TEST_ASSERT_EQUAL_INT(100, request.size);
}

static void test_a_path_needs_no_nul(void)
{
	size_t n = make(0, 2, FRAME_READ, 100, "/a", 2);

	TEST_ASSERT_EQUAL_INT(1, request_parse(bytes, n, &request, &length));
	TEST_ASSERT_EQUAL_UINT(2, request.path_len);
	TEST_ASSERT_NULL(request.data);
}

static void test_the_data_of_a_write_stand_behind_its_path(void)
{
	size_t n = make(0, 7, FRAME_WRITE, 4, "/a\0one\0", 7);

	TEST_ASSERT_EQUAL_INT(1, request_parse(bytes, n, &request, &length));
	TEST_ASSERT_EQUAL_UINT(2, request.path_len);
	TEST_ASSERT_EQUAL_UINT(4, request.data_len);
	TEST_ASSERT_EQUAL_MEMORY("one", request.data, 4);
}

/* owrust sends it so. Where a NUL stands before the last bytes, the path ends there. */
static void test_the_size_states_where_a_path_without_nul_ends(void)
{
	static const struct {
		const char *payload;
		int32_t len, size;
		uint32_t path_len, data_len;
		const char *data;
	} cases[] = {
		{"/ab-9", 5, 2, 3, 2, "-9"},     {"/ab\0\0", 5, 2, 3, 2, "\0\0"},
		{"ab", 2, 2, 0, 2, "ab"},        {"/ab\0one\0", 8, 3, 3, 4, "one"},
		{"/ab\0one", 7, 1, 3, 3, "one"},
	};

	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		size_t n = make(0, cases[i].len, FRAME_WRITE, cases[i].size, cases[i].payload,
		                (size_t)cases[i].len);

		TEST_ASSERT_EQUAL_INT(1, request_parse(bytes, n, &request, &length));
		TEST_ASSERT_EQUAL_UINT(cases[i].path_len, request.path_len);
		TEST_ASSERT_EQUAL_UINT(cases[i].data_len, request.data_len);
		TEST_ASSERT_EQUAL_MEMORY(cases[i].data, request.data, cases[i].data_len);
	}
}

static void test_tokens_of_an_owserver_belong_to_its_request(void)
{
	make(0x10002, 3, FRAME_READ, 1, "/a", 3);
	TEST_ASSERT_EQUAL_INT(0, request_parse(bytes, FRAME_HEADER + 3 + 31, &request, &length));
	TEST_ASSERT_EQUAL_INT(1, request_parse(bytes, FRAME_HEADER + 3 + 32, &request, &length));
	TEST_ASSERT_EQUAL_size_t(FRAME_HEADER + 3 + 32, length);
	/* without the bit that says who sent it there are none */
	make(1, 3, FRAME_READ, 1, "/a", 3);
	TEST_ASSERT_EQUAL_INT(1, request_parse(bytes, FRAME_HEADER + 3, &request, &length));
}

static void test_what_cannot_be_a_request_is_refused(void)
{
	static const struct {
		uint32_t version;
		int32_t payload, type, size;
		int err;
	} cases[] = {
		{0, -1, FRAME_READ, 1, -EPROTO},
		{0, INT32_MIN, FRAME_READ, 1, -EPROTO},
		{0, INT32_MAX, FRAME_READ, 1, -EMSGSIZE},
		{0, REQUEST_PAYLOAD_MAX + 1, FRAME_READ, 1, -EMSGSIZE},
		{0x1ffff, 3, FRAME_READ, 1, -EPROTO},
		{0x20000, 3, FRAME_READ, 1, -EPROTO},
		{0, 3, FRAME_WRITE, 4, -EPROTO},
		{0, 3, FRAME_WRITE, -1, -EPROTO},
	};

	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		make(cases[i].version, cases[i].payload, cases[i].type, cases[i].size, "/a", 3);
		TEST_ASSERT_EQUAL_INT(cases[i].err,
		                      request_parse(bytes, FRAME_HEADER + 3, &request, &length));
	}
}

/* Whatever comes: what is said to be there is inside what came. */
static void test_random_bytes_never_lead_outside(void)
{
	const char *given = getenv("SEED");
	unsigned seed = given ? (unsigned)strtoul(given, NULL, 0) : 20261121;
	char message[32];
	unsigned whole = 0;

	snprintf(message, sizeof(message), "SEED=%u", seed);
	srandom(seed);
	for (int round = 0; round < 20000; round++) {
		size_t have = (size_t)random() % 160;
		int state;

		for (size_t i = 0; i < have; i++)
			bytes[i] = random() % 3 ? 0 : (uint8_t)random();
		/* so that some are requests */
		if (random() % 4 && have > 7)
			bytes[0] = bytes[2] = bytes[3] = bytes[4] = bytes[5] = bytes[6] = 0;
		state = request_parse(bytes, have, &request, &length);
		if (state < 0)
			continue;
		TEST_ASSERT_TRUE_MESSAGE(length <= REQUEST_MAX, message);
		if (state == 0) {
			TEST_ASSERT_TRUE_MESSAGE(length > have, message);
			continue;
		}
		whole++;
		TEST_ASSERT_TRUE_MESSAGE(length <= have, message);
		TEST_ASSERT_TRUE_MESSAGE((const uint8_t *)request.path + request.path_len <=
		                                 bytes + length,
		                         message);
		TEST_ASSERT_NULL_MESSAGE(memchr(request.path, '\0', request.path_len), message);
		if (request.data)
			TEST_ASSERT_TRUE_MESSAGE(request.data + request.data_len <= bytes + length,
			                         message);
	}
	TEST_ASSERT_GREATER_THAN_UINT(100, whole);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_request_is_whole_at_its_last_byte);
	RUN_TEST(test_a_path_needs_no_nul);
	RUN_TEST(test_the_data_of_a_write_stand_behind_its_path);
	RUN_TEST(test_the_size_states_where_a_path_without_nul_ends);
	RUN_TEST(test_tokens_of_an_owserver_belong_to_its_request);
	RUN_TEST(test_what_cannot_be_a_request_is_refused);
	RUN_TEST(test_random_bytes_never_lead_outside);
	return UNITY_END();
}
