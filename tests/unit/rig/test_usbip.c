/* SPDX-License-Identifier: MIT */
/* Tests of the headers of USB/IP. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "unity.h"

#include "tests/kernel/usbip.h"

void setUp(void)
{
}

void tearDown(void)
{
}

static const uint8_t submit[USBIP_HEADER] = {
	[3] = 1,     [4] = 0x12, [5] = 0x34, [6] = 0x56, [7] = 0x78, [11] = 2, [15] = 1, [27] = 18,
	[40] = 0x80, 6,          0,          1,          0,          0,        18,       0,
};

static void test_a_submitted_request_is_read_field_by_field(void)
{
	struct usbip_request request;

	TEST_ASSERT_EQUAL_INT(0, usbip_decode(submit, &request));
	TEST_ASSERT_EQUAL_INT(USBIP_CMD_SUBMIT, request.command);
	TEST_ASSERT_EQUAL_HEX32(0x12345678, request.seq);
	TEST_ASSERT_TRUE(request.in);
	TEST_ASSERT_EQUAL_UINT32(0, request.endpoint);
	TEST_ASSERT_EQUAL_UINT32(18, request.length);
	TEST_ASSERT_EQUAL_HEX8_ARRAY(submit + 40, request.setup, 8);
}

static void test_the_answer_echoes_the_sequence_number_and_tells_the_bytes_moved(void)
{
	static const uint8_t expected[USBIP_HEADER] = {
		[3] = 3, [4] = 0x12, [5] = 0x34, [6] = 0x56, [7] = 0x78, [27] = 7,
	};
	struct usbip_request request;
	uint8_t answer[USBIP_HEADER];

	usbip_decode(submit, &request);
	usbip_answer(answer, &request, 0, 7);
	TEST_ASSERT_EQUAL_HEX8_ARRAY(expected, answer, USBIP_HEADER);
}

static void test_a_stall_is_a_negative_status(void)
{
	struct usbip_request request;
	uint8_t answer[USBIP_HEADER];
	static const uint8_t minus_32[] = {0xff, 0xff, 0xff, 0xe0};

	usbip_decode(submit, &request);
	usbip_answer(answer, &request, -EPIPE, 0);
	TEST_ASSERT_EQUAL_HEX8_ARRAY(minus_32, answer + 20, 4);
}

static void test_an_unlink_that_comes_too_late(void)
{
	uint8_t unlink[USBIP_HEADER] = {[3] = 2, [7] = 9, [23] = 8};
	uint8_t expected[USBIP_HEADER] = {[3] = 4, [7] = 9};
	struct usbip_request request;
	uint8_t answer[USBIP_HEADER];

	TEST_ASSERT_EQUAL_INT(0, usbip_decode(unlink, &request));
	TEST_ASSERT_FALSE(request.in);
	TEST_ASSERT_EQUAL_UINT32(8, request.unlinked);
	usbip_answer(answer, &request, 0, 5);
	TEST_ASSERT_EQUAL_HEX8_ARRAY(expected, answer, USBIP_HEADER);
}

static void test_what_no_kernel_sends_is_refused(void)
{
	struct usbip_request request;
	uint8_t header[USBIP_HEADER];

	memcpy(header, submit, sizeof(header));
	header[3] = 3;
	TEST_ASSERT_EQUAL_INT(-EPROTO, usbip_decode(header, &request));
	memcpy(header, submit, sizeof(header));
	header[24] = 1;
	TEST_ASSERT_EQUAL_INT(-EPROTO, usbip_decode(header, &request));
	memcpy(header, submit, sizeof(header));
	header[19] = 16;
	TEST_ASSERT_EQUAL_INT(-EPROTO, usbip_decode(header, &request));
}

static void test_no_random_header_passes_a_bound(void)
{
	const unsigned seed = 20482;
	struct usbip_request request;
	uint8_t header[USBIP_HEADER] = {0};

	srand(seed);
	for (int round = 0; round < 20000; round++) {
		for (unsigned i = 0; i < 4; i++)
			header[rand() % USBIP_HEADER] = (uint8_t)(rand() >> 3);
		header[3] = (uint8_t)(1 + rand() % 4);
		if (usbip_decode(header, &request) != 0)
			continue;
		TEST_ASSERT_TRUE_MESSAGE(request.length <= USBIP_MAX_DATA, "seed 20482");
		TEST_ASSERT_TRUE_MESSAGE(request.endpoint <= 15, "seed 20482");
	}
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_submitted_request_is_read_field_by_field);
	RUN_TEST(test_the_answer_echoes_the_sequence_number_and_tells_the_bytes_moved);
	RUN_TEST(test_a_stall_is_a_negative_status);
	RUN_TEST(test_an_unlink_that_comes_too_late);
	RUN_TEST(test_what_no_kernel_sends_is_refused);
	RUN_TEST(test_no_random_header_passes_a_bound);
	return UNITY_END();
}
