/* SPDX-License-Identifier: MIT */
/*
 * An owserver on a unix socket that answers on the world's clock, and what can be wrong with one:
 * it is slow, silent, gone, tells errors, power-fault readings and garbage, sends half a frame, one
 * twice, one with more behind it. The protocol has no request numbers, so an answer that comes
 * behind the next question would be taken for its answer by any client; that one lie is left out.
 */
#pragma once

#include "hal/owfs/frame.h"
#include "tests/endurance/part.h"

#define SERVER_CLIENTS 8
#define SERVER_ROOM 8192

enum lie {
	HONEST,
	SLOW,
	ALIVE,
	VERY_LATE,
	SILENT,
	REFUSES,
	CLOSES,
	HALF,
	HALF_AND_SILENT,
	GARBAGE,
	HUGE,
	NEGATIVE,
	VERSION,
	SHORTER,
	TWICE,
	MORE,
	BY_BYTES,
	ERRORS,
	NO_DEVICE,
	FAULT_85,
	FAULT_127,
	NO_NUMBER,
	EMPTY,
	LIES,
};

struct server_client {
	int fd;
	uint8_t in[SERVER_ROOM], out[SERVER_ROOM];
	unsigned got, len, sent;
	int64_t due_ns, alive_ns; /* INT64_MAX: nothing is to be sent */
	bool close, hangs, by_bytes;
};

struct server {
	char path[60];
	int listen_fd;
	bool dead;  /* no socket */
	bool hangs; /* one, and nobody behind it */
	enum lie lie;
	unsigned chance; /* of a lie, percent */
	struct server_client client[SERVER_CLIENTS];
	/* the switch */
	unsigned relays, latch, set_alarm;
	bool por;
};

static inline struct server *server_of(struct part *part)
{
	return part->own;
}

/*
 * server_lies.c: in words; a word of a frame made another; the lie in the answer that is to go out.
 */
extern const char *const server_lies[LIES];
void server_change(uint8_t *frame, unsigned word, uint32_t value);
void server_lie(struct server_client *c, enum lie lie);

/* server_answers.c: the length of the answer's text, or its code. */
int server_answer(struct part *part, const struct frame_header *request, const char *path,
                  const char *data, char *text, size_t size);
