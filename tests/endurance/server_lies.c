/* SPDX-License-Identifier: MIT */
/* What is wrong with the frame of an answer. */
#include <string.h>

#include "tests/endurance/server.h"

/* clang-format off */
const char *const server_lies[LIES] = {
	[SLOW] = "slow", [ALIVE] = "only alive", [VERY_LATE] = "very late", [SILENT] = "silent",
	[REFUSES] = "keeps no connection", [CLOSES] = "closes", [HALF] = "half an answer",
	[HALF_AND_SILENT] = "half an answer and silence", [GARBAGE] = "garbage", [HUGE] = "huge",
	[NEGATIVE] = "negative length", [VERSION] = "other version",
	[SHORTER] = "shorter than told",
	[TWICE] = "twice", [MORE] = "more than asked", [BY_BYTES] = "byte by byte",
	[ERRORS] = "errors", [NO_DEVICE] = "no device", [FAULT_85] = "85", [FAULT_127] = "127.938",
	[NO_NUMBER] = "no number", [EMPTY] = "empty",
};
/* clang-format on */

void server_change(uint8_t *frame, unsigned word, uint32_t value)
{
	for (int i = 0; i < 4; i++)
		frame[word * 4 + (unsigned)i] = (uint8_t)(value >> (24 - 8 * i));
}

void server_lie(struct server_client *c, enum lie lie)
{
	uint8_t junk[] = "HTTP/1.1 400 Bad Request";

	switch (lie) {
	case SLOW:
		c->due_ns += (int64_t)world_random(18000) * FIELD_MS;
		break;
	case ALIVE:
		c->alive_ns = c->due_ns;
		c->due_ns = INT64_MAX;
		break;
	case VERY_LATE:
		c->alive_ns = c->due_ns;
		c->due_ns += 40 * FIELD_S;
		break;
	case SILENT:
		c->due_ns = INT64_MAX;
		break;
	case REFUSES:
		c->out[15] &= (uint8_t)~FRAME_PERSIST;
		c->close = true;
		break;
	case CLOSES:
		c->len = 0;
		c->close = true;
		break;
	case HALF:
		c->len /= 2;
		c->close = true;
		break;
	case HALF_AND_SILENT:
		c->len /= 2;
		c->hangs = true;
		break;
	case GARBAGE:
		memcpy(c->out, junk, FRAME_HEADER);
		break;
	case HUGE:
		server_change(c->out, 1, 0x7fffffff);
		break;
	case NEGATIVE:
		server_change(c->out, 1, (uint32_t)-5);
		break;
	case VERSION:
		server_change(c->out, 0, 0x20000);
		break;
	case SHORTER:
		server_change(c->out, 2, 100000);
		break;
	case TWICE:
		if (c->len * 2 <= SERVER_ROOM)
			memcpy(c->out + c->len, c->out, c->len);
		c->len *= 2;
		break;
	case MORE:
		c->len += 3;
		break;
	case BY_BYTES:
		c->by_bytes = true;
		break;
	case HONEST:
	case ERRORS:
	case NO_DEVICE:
	case FAULT_85:
	case FAULT_127:
	case NO_NUMBER:
	case EMPTY:
	case LIES:
		break;
	}
}
