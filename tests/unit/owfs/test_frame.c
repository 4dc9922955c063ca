/* SPDX-License-Identifier: MIT */
/* The bytes here are those that genuine owserver tools and servers were recorded to send. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "unity.h"

#include "hal/owfs/frame.h"

static const uint8_t read_request[] = {
	0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x1d, 0x00, 0x00, 0x00, 0x02, 0x00, 0x00,
	0x00, 0x04, 0x00, 0x01, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, '/',  '2',  '8',  '.',
	'0',  '0',  '0',  '0',  '2',  '8',  'D',  '7',  '0',  '0',  '0',  '0',  '/',  't',
	'e',  'm',  'p',  'e',  'r',  'a',  't',  'u',  'r',  'e',  0x00,
};
static const uint8_t write_request[] = {
	0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x1b, 0x00, 0x00, 0x00, 0x03, 0x00,
	0x00, 0x00, 0x04, 0x00, 0x00, 0x00, 0x02, 0x00, 0x00, 0x00, 0x00, '/',  '2',
	'8',  '.',  '0',  '0',  '0',  '0',  '2',  '8',  'D',  '7',  '0',  '0',  '0',
	'0',  '/',  't',  'e',  'm',  'p',  'l',  'o',  'w',  0x00, '1',  '1',
};
static const uint8_t read_reply[] = {
	0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x0c, 0x00, 0x00, 0x00, 0x0c,
	0x00, 0x00, 0x00, 0x04, 0x00, 0x00, 0x00, 0x0c, 0x00, 0x00, 0x00, 0x00,
	' ',  ' ',  ' ',  ' ',  ' ',  ' ',  ' ',  ' ',  ' ',  ' ',  ' ',  '4',
};
static const uint8_t refusal[] = {
	0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0xff, 0xff, 0xff, 0xff,
	0x00, 0x00, 0x00, 0x04, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,
};
static const uint8_t keep_alive[] = {
	0x00, 0x00, 0x00, 0x00, 0xff, 0xff, 0xff, 0xff, 0x00, 0x00, 0x00, 0x00,
	0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,
};

static struct frame_reader reader;
static uint8_t data[64];

void setUp(void)
{
	memset(data, 0xee, sizeof(data));
	frame_begin(&reader, data, sizeof(data) / 2);
}

void tearDown(void)
{
}

static int feed(const uint8_t *bytes, size_t n)
{
	size_t used;

	return frame_feed(&reader, bytes, n, &used);
}

static int feed_changed(size_t word, uint32_t value)
{
	uint8_t bytes[sizeof(read_reply)];

	memcpy(bytes, read_reply, sizeof(bytes));
	for (size_t i = 0; i < 4; i++)
		bytes[word * 4 + i] = (uint8_t)(value >> (24 - 8 * i));
	return feed(bytes, sizeof(bytes));
}

static void test_a_read_request_is_byte_for_byte_the_recorded_one(void)
{
	static uint8_t out[FRAME_REQUEST_MAX];
	int len = frame_request(out, FRAME_READ, FRAME_PERSIST, 65536,
	                        "/28.000028D70000/temperature", NULL, 0);

	TEST_ASSERT_EQUAL_INT(sizeof(read_request), len);
	TEST_ASSERT_EQUAL_UINT8_ARRAY(read_request, out, sizeof(read_request));
}

static void test_a_write_request_is_byte_for_byte_the_recorded_one(void)
{
	static uint8_t out[FRAME_REQUEST_MAX];
	int len = frame_request(out, FRAME_WRITE, FRAME_PERSIST, 0, "/28.000028D70000/templow",
	                        (const uint8_t *)"11", 2);

	TEST_ASSERT_EQUAL_INT(sizeof(write_request), len);
	TEST_ASSERT_EQUAL_UINT8_ARRAY(write_request, out, sizeof(write_request));
}

static void test_a_greeting_has_no_data(void)
{
	static uint8_t out[FRAME_REQUEST_MAX];

	TEST_ASSERT_EQUAL_INT(FRAME_HEADER, frame_request(out, FRAME_NOP, 0, 0, NULL, NULL, 0));
	TEST_ASSERT_EQUAL_UINT8(FRAME_NOP, out[11]);
	TEST_ASSERT_EQUAL_UINT8(0, out[7]);
}

static void test_what_is_too_long_is_not_made(void)
{
	static uint8_t out[FRAME_REQUEST_MAX], much[FRAME_DATA_MAX + 1];
	char path[FRAME_PATH_MAX + 2];

	memset(path, 'x', sizeof(path));
	path[FRAME_PATH_MAX] = '\0';
	TEST_ASSERT_EQUAL_INT(FRAME_REQUEST_MAX,
	                      frame_request(out, FRAME_WRITE, 0, 0, path, much, FRAME_DATA_MAX));
	TEST_ASSERT_EQUAL_INT(
		-EMSGSIZE, frame_request(out, FRAME_WRITE, 0, 0, path, much, FRAME_DATA_MAX + 1));
	path[FRAME_PATH_MAX] = 'x';
	path[FRAME_PATH_MAX + 1] = '\0';
	TEST_ASSERT_EQUAL_INT(-EMSGSIZE, frame_request(out, FRAME_READ, 0, 1, path, NULL, 0));
}

static void test_a_header_survives_encoding_and_decoding(void)
{
	const struct frame_header header = {0x10001, -1, -95, 0xffffffff, INT32_MIN, 49154};
	struct frame_header again;
	uint8_t bytes[FRAME_HEADER];

	frame_put_header(bytes, &header);
	frame_get_header(bytes, &again);
	TEST_ASSERT_EQUAL_MEMORY(&header, &again, sizeof(header));
}

static void test_a_reply_is_read_from_any_split_into_fragments(void)
{
	for (size_t cut = 1; cut < sizeof(read_reply); cut++) {
		memset(data, 0xee, sizeof(data));
		frame_begin(&reader, data, sizeof(data) / 2);
		TEST_ASSERT_EQUAL_INT(FRAME_MORE, feed(read_reply, cut));
		TEST_ASSERT_EQUAL_INT(FRAME_WHOLE,
		                      feed(read_reply + cut, sizeof(read_reply) - cut));
		TEST_ASSERT_EQUAL_INT32(12, reader.header.payload);
		TEST_ASSERT_EQUAL_MEMORY("           4", data, 12);
		TEST_ASSERT_EQUAL_UINT8(0xee, data[12]);
	}
}

static void test_a_reply_is_read_byte_by_byte_between_keep_alives(void)
{
	for (unsigned round = 0; round < 3; round++)
		for (size_t i = 0; i < sizeof(keep_alive); i++)
			TEST_ASSERT_EQUAL_INT(i + 1 < sizeof(keep_alive) ? FRAME_MORE : FRAME_ALIVE,
			                      feed(keep_alive + i, 1));
	for (size_t i = 0; i < sizeof(read_reply); i++)
		TEST_ASSERT_EQUAL_INT(i + 1 < sizeof(read_reply) ? FRAME_MORE : FRAME_WHOLE,
		                      feed(read_reply + i, 1));
	TEST_ASSERT_EQUAL_INT32(12, reader.header.type);
	TEST_ASSERT_EQUAL_MEMORY("           4", data, 12);
}

static void test_a_reply_without_data_is_whole_with_its_header(void)
{
	TEST_ASSERT_EQUAL_INT(FRAME_WHOLE, feed(refusal, sizeof(refusal)));
	TEST_ASSERT_EQUAL_INT32(-1, reader.header.type);
	TEST_ASSERT_EQUAL_UINT32(FRAME_PERSIST, reader.header.flags);
}

static void test_a_refused_reading_has_its_cause_and_number_beside_the_code(void)
{
	static const int errs[] = {-EDOM, -ERANGE, -EBADMSG, -ECOMM, -EIO, -ENOTCONN, 0};
	uint8_t bytes[FRAME_HEADER];
	double number;

	for (size_t i = 0; i < sizeof(errs) / sizeof(errs[0]); i++) {
		struct frame_header header = {.type = -5};
		int known = i < 4 ? errs[i] : 0;

		frame_put_cause(&header, errs[i], -109.9375);
		frame_put_header(bytes, &header);
		header = (struct frame_header){0};
		frame_get_header(bytes, &header);
		TEST_ASSERT_EQUAL_INT(known, frame_cause(&header, &number));
		TEST_ASSERT_EQUAL_DOUBLE(i ? 0 : -109.9375, number);
		TEST_ASSERT_EQUAL_INT32(-5, header.type);
		if (!known)
			TEST_ASSERT_EQUAL_INT32(0, header.offset);
	}
	for (int64_t offset = INT32_MIN; offset <= INT32_MAX; offset += 0x10001) {
		const struct frame_header other = {.type = -5, .offset = (int32_t)offset};

		TEST_ASSERT_EQUAL_INT(0, frame_cause(&other, &number));
	}
}

static void test_what_follows_a_frame_is_left(void)
{
	uint8_t bytes[2 * sizeof(read_reply)];
	size_t used;

	memcpy(bytes, read_reply, sizeof(read_reply));
	memcpy(bytes + sizeof(read_reply), read_reply, sizeof(read_reply));
	TEST_ASSERT_EQUAL_INT(FRAME_WHOLE, frame_feed(&reader, bytes, sizeof(bytes), &used));
	TEST_ASSERT_EQUAL_size_t(sizeof(read_reply), used);
	frame_begin(&reader, data, sizeof(data) / 2);
	TEST_ASSERT_EQUAL_INT(FRAME_ALIVE,
	                      frame_feed(&reader, keep_alive, sizeof(keep_alive), &used));
	TEST_ASSERT_EQUAL_size_t(sizeof(keep_alive), used);
}

static void test_the_limit_is_checked_before_a_byte_is_stored(void)
{
	frame_begin(&reader, data, 12);
	TEST_ASSERT_EQUAL_INT(FRAME_WHOLE, feed(read_reply, sizeof(read_reply)));
	memset(data, 0xee, sizeof(data));
	frame_begin(&reader, data, 11);
	TEST_ASSERT_EQUAL_INT(-EMSGSIZE, feed(read_reply, sizeof(read_reply)));
	TEST_ASSERT_EQUAL_UINT8(0xee, data[0]);
	frame_begin(&reader, data, 32);
	TEST_ASSERT_EQUAL_INT(-EMSGSIZE, feed_changed(1, 0x7fffffff));
}

static void test_a_negative_payload_other_than_keep_alive_is_garbage(void)
{
	TEST_ASSERT_EQUAL_INT(-EPROTO, feed_changed(1, (uint32_t)-5));
	setUp();
	TEST_ASSERT_EQUAL_INT(-EPROTO, feed_changed(1, 0x80000000));
}

static void test_a_strange_version_is_garbage(void)
{
	const uint32_t strange[] = {0x20000, 0x48545450, 0x1, 0x1ffff, 0x80000000};

	for (unsigned i = 0; i < sizeof(strange) / sizeof(strange[0]); i++) {
		setUp();
		TEST_ASSERT_EQUAL_INT(-EPROTO, feed_changed(0, strange[i]));
	}
}

static void test_tokens_behind_the_data_are_skipped(void)
{
	uint8_t bytes[sizeof(read_reply) + 16];

	memset(bytes, 0x55, sizeof(bytes));
	memcpy(bytes, read_reply, sizeof(read_reply));
	bytes[1] = 1;
	bytes[3] = 1;
	TEST_ASSERT_EQUAL_INT(FRAME_MORE, feed(bytes, sizeof(read_reply) + 7));
	TEST_ASSERT_EQUAL_INT(FRAME_WHOLE, feed(bytes + sizeof(read_reply) + 7, 9));
	TEST_ASSERT_EQUAL_UINT8(0xee, data[12]);
}

static void test_no_bytes_at_all_break_the_reader(void)
{
	const unsigned seed = 4304;

	srand(seed);
	for (unsigned round = 0; round < 20000; round++) {
		uint8_t bytes[96];
		size_t at = 0, used = 0;
		int state = FRAME_MORE;

		setUp();
		for (size_t i = 0; i < sizeof(bytes); i++)
			bytes[i] = (uint8_t)(rand() % 4 ? 0 : rand());
		while (at < sizeof(bytes) && (state == FRAME_MORE || state == FRAME_ALIVE)) {
			size_t n = 1 + (size_t)rand() % (sizeof(bytes) - at);

			state = frame_feed(&reader, bytes + at, n, &used);
			TEST_ASSERT_LESS_OR_EQUAL_size_t_MESSAGE(n, used, "seed 4304");
			TEST_ASSERT_GREATER_THAN_size_t_MESSAGE(0, used, "seed 4304");
			at += used;
		}
		for (size_t i = sizeof(data) / 2; i < sizeof(data); i++)
			TEST_ASSERT_EQUAL_UINT8_MESSAGE(0xee, data[i], "seed 4304");
	}
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_a_read_request_is_byte_for_byte_the_recorded_one);
	RUN_TEST(test_a_write_request_is_byte_for_byte_the_recorded_one);
	RUN_TEST(test_a_greeting_has_no_data);
	RUN_TEST(test_what_is_too_long_is_not_made);
	RUN_TEST(test_a_header_survives_encoding_and_decoding);
	RUN_TEST(test_a_reply_is_read_from_any_split_into_fragments);
	RUN_TEST(test_a_reply_is_read_byte_by_byte_between_keep_alives);
	RUN_TEST(test_a_reply_without_data_is_whole_with_its_header);
	RUN_TEST(test_a_refused_reading_has_its_cause_and_number_beside_the_code);
	RUN_TEST(test_what_follows_a_frame_is_left);
	RUN_TEST(test_the_limit_is_checked_before_a_byte_is_stored);
	RUN_TEST(test_a_negative_payload_other_than_keep_alive_is_garbage);
	RUN_TEST(test_a_strange_version_is_garbage);
	RUN_TEST(test_tokens_behind_the_data_are_skipped);
	RUN_TEST(test_no_bytes_at_all_break_the_reader);
	return UNITY_END();
}
