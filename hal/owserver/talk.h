/* SPDX-License-Identifier: MIT */
/*
 * Requests and replies of the owserver protocol over one kept connection.
 *
 * When a kept connection turns out to be closed before a byte of the answer came, as owserver does
 * to idle ones, the request is repeated once on a new connection; a WRITE only if none of it was
 * sent, because a write must not happen twice.
 *
 * Room hal/owserver: a genuine owserver as a target.
 */
#pragma once

#include "hal/owfs/frame.h"
#include "hal/owserver/connection.h"

enum talk_counter {
	TALK_REQUESTS,    /* requests to the owserver */
	TALK_KEEPALIVES,  /* keep-alives of a server that works */
	TALK_CONNECTIONS, /* opened connections */
	TALK_REFUSED,     /* answers after which the server closed, though asked to keep open */
	TALK_STALE,       /* idle connections that the server had closed; no failure */
	TALK_GARBAGE,     /* answers that are none */
	TALK_FLOODS,      /* requests given up for too many keep-alives */
	TALK_TIMEOUTS,    /* requests without an answer in time */
	TALK_BYTES_IN,    /* bytes of the server */
	TALK_BYTES_OUT,   /* bytes to the server */
	TALK_COUNTERS,
};

struct talk {
	struct connection connection;
	struct frame_reader reader;  /* reader.header is that of the last reply */
	int64_t asked_ns;            /* when the wait for this reply began */
	uint32_t alives, pieces;     /* keep-alives and pieces of this reply */
	bool heard;                  /* bytes came since the caller cleared it */
	char trouble[128];           /* why an exchange failed, as a sentence */
	struct bus_counter *counter; /* by enum talk_counter */
	const uint8_t *tokens;       /* sent with each request: the servers that it came through */
	uint32_t token_count;
	uint8_t in[4096];
	uint8_t out[FRAME_REQUEST_MAX + FRAME_TOKENS_SENT * FRAME_TOKEN_SIZE];
	uint8_t scrap[64];
};

struct talk_request {
	enum frame_type type;
	bool fresh;
	const char *path;
	int32_t size;        /* READ: bytes asked for */
	const uint8_t *data; /* WRITE */
	uint32_t data_len, offset;
	uint8_t *room; /* where the reply's data go; NULL: nowhere */
	uint32_t limit;
};

/*
 * Ask and wait for the reply. 0: talk->reader has it. Otherwise the connection is closed, trouble
 * is set, and the result is
 *   -EMSGSIZE     the path or the data are too long, nothing was sent (connection kept)
 *   -ECONNREFUSED no connection
 *   -ECONNRESET   closed by the peer
 *   -EPROTO       garbage, or keep-alives without end
 *   -ETIMEDOUT    nothing heard until the deadline
 *   -EINPROGRESS  heard, but no whole reply by then; or the host shuts down
 */
int talk_exchange(struct talk *talk, const struct talk_request *request, int64_t deadline_ns);

/*
 * The two halves of talk_exchange(), on an open connection. Errors of the second as above, and
 * -EAGAIN: not yet.
 */
int talk_send(struct talk *talk, const struct talk_request *request, int64_t until_ns);
int talk_receive(struct talk *talk, int64_t until_ns);
