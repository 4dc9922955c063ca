/* SPDX-License-Identifier: MIT */
/* The protocol: whole requests out of a stream, and what is answered. Pure. */
#pragma once

#include <stddef.h>

#include "src/faces/modbus/layout.h"

#define FRAME_HEAD 7
#define FRAME_PDU_MOST 253
#define FRAME_MOST (FRAME_HEAD + FRAME_PDU_MOST)
#define FRAME_WRITES_MOST 1968 /* values of one request */

enum exception {
	EXCEPTION_NONE,
	EXCEPTION_FUNCTION,       /* no such function, or not for this client */
	EXCEPTION_ADDRESS,        /* no signal has, or had, the address */
	EXCEPTION_VALUE,          /* the request is wrong, or the signal takes no such value */
	EXCEPTION_FAILURE,        /* owsd refuses the command */
	EXCEPTION_BUSY = 6,       /* in the moment of a reload: ask again */
	EXCEPTION_NO_TARGET = 11, /* the value is not good */
};

/* Where values come from. */
struct answer_source {
	bool little, exceptions; /* WordOrder, BadValue */
	unsigned unit;           /* UnitId */
	/* What a place has. Of one that a signal had that is gone: not good, and had alone. */
	enum exception (*row)(void *ctx, unsigned place, struct layout_row *row, bool *has);
	void (*header)(void *ctx, uint16_t registers[LAYOUT_RECORD]);
	/* May this client command that place, or write its beat? Then commit() does so. */
	enum exception (*write)(void *ctx, unsigned place, double number);
	enum exception (*beat)(void *ctx);
	/* All that is written by one request, or nothing. */
	enum exception (*commit)(void *ctx);
	void *ctx;
};

/* Bytes of the first request of the stream; 0: it is not whole; -EBADMSG: it is none. */
int frame_length(const uint8_t *bytes, size_t n);
/* Answer a whole one. Returns how long the answer is. */
size_t frame_answer(const struct answer_source *source, const uint8_t *request,
                    uint8_t answer[FRAME_MOST]);
/* Did a request that is none to read get an exception? Pure. */
bool frame_refused(const uint8_t *request, const uint8_t *answer);
