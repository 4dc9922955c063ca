/* SPDX-License-Identifier: MIT */
/* Tests of the tokens of the servers that a request came through. */
#include <string.h>
#include <unity.h>

#include "hal/owfs/frame.h"
#include "src/daemon/serve/request.h"

static uint8_t here[BUS_TOKEN], there[BUS_TOKEN];
static struct tokens passed;

void setUp(void)
{
	tokens_own(here);
	tokens_own(there);
	memset(&passed, 0, sizeof(passed));
}

void tearDown(void)
{
}

static void test_tokens_differ(void)
{
	TEST_ASSERT_NOT_EQUAL_INT(0, memcmp(here, there, BUS_TOKEN));
	TEST_ASSERT_EQUAL_UINT8(0, here[0]);
}

static void test_a_request_of_a_program_goes_on_with_our_token(void)
{
	TEST_ASSERT_FALSE(tokens_came_round(NULL, 0, here));
	tokens_pass(&passed, NULL, 0, here);
	TEST_ASSERT_EQUAL_UINT32(1, passed.count);
	TEST_ASSERT_EQUAL_UINT8_ARRAY(here, passed.bytes, BUS_TOKEN);
}

static void test_what_passed_here_has_come_round(void)
{
	struct tokens next;

	tokens_pass(&passed, NULL, 0, here);
	TEST_ASSERT_FALSE(tokens_came_round(passed.bytes, passed.count, there));
	tokens_pass(&next, passed.bytes, passed.count, there);
	TEST_ASSERT_EQUAL_UINT32(2, next.count);
	TEST_ASSERT_TRUE(tokens_came_round(next.bytes, next.count, here));
	TEST_ASSERT_TRUE(tokens_came_round(next.bytes, next.count, there));
}

/* As owserver 3.2p4 passes 6ea24ad6... on: 00a24ad6... */
static void test_a_token_whose_first_byte_was_cleared_is_known(void)
{
	uint8_t old[BUS_TOKEN];

	memcpy(old, here, sizeof(old));
	old[0] = 0x6e;
	tokens_pass(&passed, NULL, 0, old);
	passed.bytes[0] = 0;
	TEST_ASSERT_TRUE(tokens_came_round(passed.bytes, passed.count, old));
	TEST_ASSERT_TRUE(tokens_came_round(passed.bytes, passed.count, here));
}

static void test_a_chain_that_is_too_long_is_taken_for_a_ring(void)
{
	uint8_t tokens[(BUS_TOKENS_MAX + 1) * BUS_TOKEN] = {0};

	TEST_ASSERT_FALSE(tokens_came_round(tokens, BUS_TOKENS_MAX - 1, here));
	tokens_pass(&passed, tokens, BUS_TOKENS_MAX - 1, here);
	TEST_ASSERT_EQUAL_UINT32(BUS_TOKENS_MAX, passed.count);
	TEST_ASSERT_TRUE(tokens_came_round(tokens, BUS_TOKENS_MAX, here));
}

static void test_tokens_travel_behind_a_request(void)
{
	static uint8_t frame[FRAME_REQUEST_MAX + FRAME_TOKENS_SENT * FRAME_TOKEN_SIZE];
	struct request request;
	size_t length;
	int n;

	tokens_pass(&passed, there, 1, here);
	n = frame_request(frame, FRAME_WRITE, 0, 0, "/a", (const uint8_t *)"xy", 2);
	n = frame_add_tokens(frame, n, passed.bytes, passed.count);
	TEST_ASSERT_EQUAL_INT(FRAME_HEADER + 3 + 2 + 32, n);
	TEST_ASSERT_EQUAL_INT(0, request_parse(frame, (size_t)n - 1, &request, &length));
	TEST_ASSERT_EQUAL_INT(1, request_parse(frame, (size_t)n, &request, &length));
	TEST_ASSERT_EQUAL_UINT32(2, request.token_count);
	TEST_ASSERT_EQUAL_UINT8_ARRAY(passed.bytes, request.tokens, 32);
	TEST_ASSERT_EQUAL_UINT32(2, request.data_len);
}

static void test_without_tokens_a_request_is_as_it_was(void)
{
	static uint8_t frame[FRAME_REQUEST_MAX], same[FRAME_REQUEST_MAX];
	int n = frame_request(frame, FRAME_READ, 0, 9, "/a", NULL, 0);

	memcpy(same, frame, sizeof(same));
	TEST_ASSERT_EQUAL_INT(n, frame_add_tokens(frame, n, NULL, 0));
	TEST_ASSERT_EQUAL_UINT8_ARRAY(same, frame, n);
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_tokens_differ);
	RUN_TEST(test_a_request_of_a_program_goes_on_with_our_token);
	RUN_TEST(test_what_passed_here_has_come_round);
	RUN_TEST(test_a_token_whose_first_byte_was_cleared_is_known);
	RUN_TEST(test_a_chain_that_is_too_long_is_taken_for_a_ring);
	RUN_TEST(test_tokens_travel_behind_a_request);
	RUN_TEST(test_without_tokens_a_request_is_as_it_was);
	return UNITY_END();
}
