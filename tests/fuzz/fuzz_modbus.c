/* SPDX-License-Identifier: MIT */
/*
 * A stream of a Modbus TCP client. Its first byte are options of the server: WordOrder, BadValue,
 * UnitId. Whatever comes is cut into the same requests wherever the stream pauses, each has a whole
 * answer of its own, and what is refused as a whole changed nothing.
 */
#include <errno.h>
#include <string.h>

#include "src/faces/modbus/answer.h"
#include "tests/fuzz/fuzz.h"

size_t fuzz_memory(size_t n)
{
	return 4096 + n;
}

static unsigned asked, done;

/* Places to 40: some are bad, some were removed, one is in the moment of a reload. */
static enum exception row_of(void *ctx, unsigned place, struct layout_row *row, bool *has)
{
	(void)ctx;
	TEST_ASSERT_TRUE(place > 0 && place < LAYOUT_PLACES);
	if (place > 40)
		return EXCEPTION_ADDRESS;
	*has = place % 5;
	*row = (struct layout_row){.good = place % 3 && *has,
	                           .number = place * 1e5,
	                           .age_ns = (int64_t)place << 40,
	                           .decimals = place % 7};
	return place == 40 ? EXCEPTION_BUSY : EXCEPTION_NONE;
}

static void header_of(void *ctx, uint16_t registers[LAYOUT_RECORD])
{
	(void)ctx;
	memset(registers, 0x5a, LAYOUT_RECORD * sizeof(*registers));
}

static enum exception write_to(void *ctx, unsigned place, double number)
{
	(void)ctx;
	TEST_ASSERT_TRUE(place > 0 && place <= 40 && number - number == 0);
	asked++;
	return place % 4 ? EXCEPTION_NONE : EXCEPTION_ADDRESS;
}

static enum exception beat_of(void *ctx)
{
	return write_to(ctx, 1, 0);
}

static enum exception commit(void *ctx)
{
	(void)ctx;
	TEST_ASSERT_TRUE(!done && asked && asked <= FRAME_WRITES_MOST);
	done = asked;
	return EXCEPTION_NONE;
}

static void take(const struct answer_source *source, const uint8_t *request)
{
	uint8_t answer[FRAME_MOST];
	size_t len;

	asked = done = 0;
	len = frame_answer(source, request, answer);
	TEST_ASSERT_TRUE(len >= 9 && len <= FRAME_MOST);
	TEST_ASSERT_EQUAL_INT((int)len, frame_length(answer, len));
	TEST_ASSERT_EQUAL_MEMORY(request, answer, 4);
	TEST_ASSERT_EQUAL_HEX8(request[6], answer[6]);
	if (len > 9 || answer[7] == request[7]) {
		TEST_ASSERT_EQUAL_HEX8(request[7], answer[7]);
		TEST_ASSERT_EQUAL_UINT(asked, done);
	} else {
		TEST_ASSERT_EQUAL_HEX8(request[7] | 0x80, answer[7]);
		TEST_ASSERT_EQUAL_UINT(0, done);
	}
}

void fuzz_one(const uint8_t *bytes, size_t n)
{
	struct answer_source source = {.row = row_of,
	                               .header = header_of,
	                               .write = write_to,
	                               .beat = beat_of,
	                               .commit = commit};
	size_t at = 1;

	if (!n)
		return;
	source.little = bytes[0] & 1;
	source.exceptions = bytes[0] & 2;
	source.unit = bytes[0] >> 2;
	while (at < n) {
		int length = frame_length(bytes + at, n - at);

		for (size_t len = 0; len < n - at && len < FRAME_MOST; len++) {
			int early = frame_length(bytes + at, len);

			TEST_ASSERT_TRUE_MESSAGE(early == 0 || early == length, "another verdict");
		}
		if (length <= 0)
			return;
		take(&source, bytes + at);
		at += (size_t)length;
	}
}
