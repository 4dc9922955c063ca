/* SPDX-License-Identifier: MIT */
/* Tests of requests and answers, byte by byte. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "unity.h"

#include "src/faces/modbus/answer.h"
#include "src/public/ows.h"

/* Places: 1 is good, 2 is bad, 3 was removed, 4 is in the moment of a reload. */
static enum exception row_of(void *ctx, unsigned place, struct layout_row *row, bool *has)
{
	int *looks = ctx;

	++*looks;
	if (place > 4)
		return EXCEPTION_ADDRESS;
	if (place == 4)
		return EXCEPTION_BUSY;
	*has = place != 3;
	*row = (struct layout_row){.good = place == 1,
	                           .number = 21.5,
	                           .quality = place == 1 ? OWS_Q_GOOD : OWS_Q_NO_DEVICE,
	                           .alarm = place == 2 ? LAYOUT_ALARM_LIMIT : 0};
	return EXCEPTION_NONE;
}

static void header_of(void *ctx, uint16_t registers[LAYOUT_RECORD])
{
	(void)ctx;
	for (unsigned i = 0; i < LAYOUT_RECORD; i++)
		registers[i] = (uint16_t)(0x100 + i);
}

/* What is asked for, "1=21.5 " for each, and "done". Place 2 is not to be written. */
static char written[200];

static void note(const char *one)
{
	if (strlen(written) + strlen(one) < sizeof(written))
		strcat(written, one);
}

static enum exception write_to(void *ctx, unsigned place, double number)
{
	char one[40];

	(void)ctx;
	if (place != 1 && place != 3)
		return EXCEPTION_ADDRESS;
	snprintf(one, sizeof(one), "%u=%g ", place, number);
	note(one);
	return EXCEPTION_NONE;
}

static enum exception beat_of(void *ctx)
{
	(void)ctx;
	note("beat ");
	return EXCEPTION_NONE;
}

static enum exception commit(void *ctx)
{
	(void)ctx;
	note("done ");
	return strstr(written, "=99 ") ? EXCEPTION_BUSY : EXCEPTION_NONE;
}

static int looks;
static struct answer_source source;
static uint8_t answer[FRAME_MOST];

void setUp(void)
{
	looks = 0;
	written[0] = '\0';
	source = (struct answer_source){.row = row_of,
	                                .header = header_of,
	                                .write = write_to,
	                                .beat = beat_of,
	                                .commit = commit,
	                                .ctx = &looks};
}

void tearDown(void)
{
}

/* A request of a function, an address and a count; its answer is in answer. */
static size_t ask(uint8_t function, unsigned address, unsigned count)
{
	uint8_t request[] = {0x12,
	                     0x34,
	                     0,
	                     0,
	                     0,
	                     6,
	                     9,
	                     function,
	                     (uint8_t)(address >> 8),
	                     (uint8_t)address,
	                     (uint8_t)(count >> 8),
	                     (uint8_t)count};
	size_t len;

	TEST_ASSERT_EQUAL_INT(sizeof(request), frame_length(request, sizeof(request)));
	memset(answer, 0xee, sizeof(answer));
	len = frame_answer(&source, request, answer);
	TEST_ASSERT_EQUAL_INT((int)len, frame_length(answer, len));
	TEST_ASSERT_EQUAL_MEMORY(request, answer, 4);
	TEST_ASSERT_EQUAL_HEX8(9, answer[6]);
	/* what is refused is a command */
	TEST_ASSERT_EQUAL(function > 4 && len == FRAME_HEAD + 2, frame_refused(request, answer));
	return len;
}

static void answers(uint8_t function, unsigned address, unsigned count, const char *bytes,
                    size_t len)
{
	TEST_ASSERT_EQUAL_size_t(FRAME_HEAD + 1 + len, ask(function, address, count));
	TEST_ASSERT_EQUAL_HEX8(function, answer[7]);
	TEST_ASSERT_EQUAL_HEX8_ARRAY(bytes, answer + 8, len);
}

static void refuses(uint8_t function, unsigned address, unsigned count, enum exception why)
{
	TEST_ASSERT_EQUAL_size_t(FRAME_HEAD + 2, ask(function, address, count));
	TEST_ASSERT_EQUAL_HEX8(function | 0x80, answer[7]);
	TEST_ASSERT_EQUAL_INT(why, answer[8]);
}

static void test_registers_are_read_by_both_functions(void)
{
	answers(3, 16, 6, "\x0c\x40\x35\x80\0\0\0\0\0\x41\xac\0\0", 13);
	answers(4, 20, 2, "\x04\x41\xac\0\0", 5);
	answers(4, 14, 3, "\x06\x01\x0e\x01\x0f\x40\x35", 7);
	TEST_ASSERT_EQUAL_INT(3, looks); /* once for each request, not for each register */
	answers(3, 46002, 4, "\x08\x41\xac\0\0\x7f\xc0\0\0", 9);
	source.little = true;
	answers(3, 46002, 2, "\x04\0\0\x41\xac", 5);
}

static void test_what_is_not_good_is_no_number_or_an_exception(void)
{
	answers(3, 16 * 2 + 8, 2, "\x04\x80\0\0\x08", 5);
	answers(3, 16 * 3 + 8, 2, "\x04\x80\0\0\x08", 5); /* so a block over it can be read */
	source.exceptions = true;
	refuses(3, 16 * 2, 4, EXCEPTION_NO_TARGET);
	refuses(3, 16 + 8, 24, EXCEPTION_NO_TARGET);
	answers(3, 16 * 2 + 9, 1, "\x02\0\x08", 3);
}

static void test_an_address_without_a_signal_is_refused(void)
{
	refuses(3, 16 * 5, 1, EXCEPTION_ADDRESS);
	refuses(3, 16 * 3, 17, EXCEPTION_BUSY);
	refuses(3, 65535, 1, EXCEPTION_ADDRESS);
	refuses(3, 65535, 2, EXCEPTION_ADDRESS);
	refuses(3, 40000, 1, EXCEPTION_ADDRESS);
	refuses(3, 0, 0, EXCEPTION_VALUE);
	refuses(3, 0, 126, EXCEPTION_VALUE);
	refuses(1, 0, 2001, EXCEPTION_VALUE);
}

static void test_a_bit_says_that_the_value_is_not_0_or_that_it_is_good_or_has_an_alarm(void)
{
	answers(1, 1, 1, "\x01\x01", 2);
	answers(2, 1, 1, "\x01\x01", 2);
	refuses(1, 1, 2, EXCEPTION_NO_TARGET);
	refuses(1, 3, 1, EXCEPTION_ADDRESS);
	refuses(1, 0, 1, EXCEPTION_ADDRESS);
	answers(2, 10001, 2, "\x01\x01", 2);
	answers(2, 20001, 2, "\x01\x02", 2);
	refuses(1, 10001, 1, EXCEPTION_ADDRESS);
	refuses(2, 65535, 9, EXCEPTION_ADDRESS);
}

static void test_what_is_no_request_is_refused(void)
{
	uint8_t longer[] = {0, 1, 0, 0, 0, 7, 1, 3, 0, 0, 0, 1, 0};

	refuses(7, 0, 0, EXCEPTION_FUNCTION);
	refuses(0x83, 0, 1, EXCEPTION_FUNCTION);
	TEST_ASSERT_EQUAL_size_t(9, frame_answer(&source, longer, answer));
	TEST_ASSERT_EQUAL_HEX8(EXCEPTION_VALUE, answer[8]);
}

/* A write of several: its answer, or exception, is in answer. */
static void write_some(uint8_t function, unsigned address, unsigned count, const char *data,
                       size_t len)
{
	uint8_t request[FRAME_MOST] = {0x12,
	                               0x34,
	                               0,
	                               0,
	                               0,
	                               (uint8_t)(7 + len),
	                               9,
	                               function,
	                               (uint8_t)(address >> 8),
	                               (uint8_t)address,
	                               (uint8_t)(count >> 8),
	                               (uint8_t)count,
	                               (uint8_t)len};

	memcpy(request + 13, data, len);
	written[0] = '\0';
	frame_answer(&source, request, answer);
	if (answer[7] == function)
		TEST_ASSERT_EQUAL_MEMORY(request + 8, answer + 8, 4);
	else
		TEST_ASSERT_EQUAL_HEX8(function | 0x80, answer[7]);
}

static void test_a_number_is_written_in_each_form_and_as_a_whole(void)
{
	write_some(16, 16, 4, "\x40\x35\x80\0\0\0\0\0", 8);
	TEST_ASSERT_EQUAL_STRING("1=21.5 done ", written);
	write_some(16, 46002, 2, "\x41\xac\0\0", 4);
	TEST_ASSERT_EQUAL_STRING("1=21.5 done ", written);
	answers(6, 16 + 8, 0xfffe, "\0\x18\xff\xfe", 4);
	TEST_ASSERT_EQUAL_STRING("1=21.5 done 1=-2 done ", written);
	answers(6, 12, 7, "\0\x0c\0\x07", 4);
	TEST_ASSERT_EQUAL_STRING("1=21.5 done 1=-2 done beat done ", written);
	source.little = true;
	write_some(16, 46002, 2, "\0\0\x41\xac", 4);
	TEST_ASSERT_EQUAL_STRING("1=21.5 done ", written);
}

static void test_half_a_number_none_and_what_is_beside_it_are_not_written(void)
{
	refuses(6, 16, 1, EXCEPTION_VALUE);
	refuses(6, 17, 1, EXCEPTION_ADDRESS);
	refuses(6, 16 + 9, 1, EXCEPTION_ADDRESS);
	refuses(6, 0, 1, EXCEPTION_ADDRESS);
	refuses(6, 16 + 8, 0x8000, EXCEPTION_VALUE);
	refuses(6, 32 + 8, 1, EXCEPTION_ADDRESS);
	refuses(5, 1, 1, EXCEPTION_VALUE);
	write_some(16, 46002, 2, "\x7f\xc0\0\0", 4);
	TEST_ASSERT_EQUAL_HEX8(EXCEPTION_VALUE, answer[8]);
	write_some(16, 46002, 4, "\x41\xac\0\0\x41\xac\0\0", 8);
	TEST_ASSERT_EQUAL_HEX8(EXCEPTION_ADDRESS,
	                       answer[8]); /* place 2 takes nothing, so 1 neither */
	TEST_ASSERT_EQUAL_STRING("1=21.5 ", written);
	write_some(16, 46002, 2, "\x41\xac\0", 3);
	TEST_ASSERT_EQUAL_HEX8(EXCEPTION_VALUE, answer[8]);
	write_some(16, 46002, 0, "", 0);
	TEST_ASSERT_EQUAL_HEX8(EXCEPTION_VALUE, answer[8]);
	write_some(16, 46002, 2, "\x42\xc6\0\0", 4);
	TEST_ASSERT_EQUAL_HEX8(EXCEPTION_BUSY, answer[8]);
}

static void test_bits_are_written_as_1_and_0(void)
{
	answers(5, 1, 0xff00, "\0\x01\xff\0", 4);
	answers(5, 1, 0, "\0\x01\0\0", 4);
	TEST_ASSERT_EQUAL_STRING("1=1 done 1=0 done ", written);
	write_some(15, 1, 1, "\xff", 1);
	TEST_ASSERT_EQUAL_STRING("1=1 done ", written);
	write_some(15, 1, 3, "\x05", 1);
	TEST_ASSERT_EQUAL_HEX8(EXCEPTION_ADDRESS, answer[8]);
	write_some(15, 1, 9, "\x05", 1);
	TEST_ASSERT_EQUAL_HEX8(EXCEPTION_VALUE, answer[8]);
}

static void test_a_unit_answers_alone_if_one_is_named(void)
{
	source.unit = 9;
	answers(3, 0, 1, "\x02\x01\0", 3);
	source.unit = 8;
	refuses(3, 0, 1, EXCEPTION_NO_TARGET);
}

static void test_a_stream_is_cut_into_requests(void)
{
	const uint8_t bytes[] = {0, 1, 0, 0, 0, 6, 1, 3, 0, 0, 0, 1, 0, 2};
	uint8_t wrong[] = {0, 1, 0, 1, 0, 6};

	for (size_t n = 0; n < 12; n++)
		TEST_ASSERT_EQUAL_INT(0, frame_length(bytes, n));
	TEST_ASSERT_EQUAL_INT(12, frame_length(bytes, 12));
	TEST_ASSERT_EQUAL_INT(12, frame_length(bytes, sizeof(bytes)));
	TEST_ASSERT_EQUAL_INT(-EBADMSG, frame_length(wrong, 4));
	wrong[3] = 0;
	wrong[5] = 1;
	TEST_ASSERT_EQUAL_INT(-EBADMSG, frame_length(wrong, 6));
	wrong[5] = 255;
	TEST_ASSERT_EQUAL_INT(-EBADMSG, frame_length(wrong, 6));
	wrong[5] = 254;
	TEST_ASSERT_EQUAL_INT(0, frame_length(wrong, 6));
}

/* xorshift64 */
static uint64_t next(uint64_t *state)
{
	*state ^= *state << 13;
	*state ^= *state >> 7;
	*state ^= *state << 17;
	return *state;
}

static void test_whatever_is_asked_has_a_whole_answer(void)
{
	uint64_t state = 88172645463325252u;
	uint8_t request[FRAME_MOST];

	for (unsigned i = 0; i < 200000; i++) {
		uint64_t how = next(&state);
		unsigned length = how & 1 ? 6 : 2 + (unsigned)(how >> 8) % FRAME_PDU_MOST;
		size_t len;
		int whole;

		for (size_t k = 0; k < sizeof(request); k++)
			request[k] = (uint8_t)(next(&state) >> 24);
		request[2] = request[3] = 0;
		request[4] = 0;
		request[5] = (uint8_t)length;
		if (how & 2)
			request[7] &= 7;
		if (how & 4)
			request[10] = 0;
		source.exceptions = how & 8;
		source.little = how & 16;
		whole = frame_length(request, sizeof(request));
		TEST_ASSERT_EQUAL_INT(6 + (int)length, whole);
		memset(answer, 0xee, sizeof(answer));
		len = frame_answer(&source, request, answer);
		TEST_ASSERT_TRUE(len >= 9 && len <= FRAME_MOST);
		TEST_ASSERT_EQUAL_INT((int)len, frame_length(answer, len));
		TEST_ASSERT_EQUAL_MEMORY(request, answer, 4);
		TEST_ASSERT_TRUE(answer[7] == request[7] ||
		                 (answer[7] == (request[7] | 0x80) && len == 9));
	}
}

int main(void)
{
	UNITY_BEGIN();
	RUN_TEST(test_registers_are_read_by_both_functions);
	RUN_TEST(test_what_is_not_good_is_no_number_or_an_exception);
	RUN_TEST(test_an_address_without_a_signal_is_refused);
	RUN_TEST(test_a_bit_says_that_the_value_is_not_0_or_that_it_is_good_or_has_an_alarm);
	RUN_TEST(test_what_is_no_request_is_refused);
	RUN_TEST(test_a_number_is_written_in_each_form_and_as_a_whole);
	RUN_TEST(test_half_a_number_none_and_what_is_beside_it_are_not_written);
	RUN_TEST(test_bits_are_written_as_1_and_0);
	RUN_TEST(test_a_unit_answers_alone_if_one_is_named);
	RUN_TEST(test_a_stream_is_cut_into_requests);
	RUN_TEST(test_whatever_is_asked_has_a_whole_answer);
	return UNITY_END();
}
