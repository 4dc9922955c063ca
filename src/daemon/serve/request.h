/* SPDX-License-Identifier: MIT */
/*
 * A request of the owserver protocol as it stands in a buffer. Pure functions over bytes of clients
 * that may be hostile: every length is checked here before it is used.
 */
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "hal/bus/bus.h"

/* The longest frame that the server accepts: header, path, data, and the tokens of an owserver. */
#define REQUEST_PAYLOAD_MAX (1024 + 65536)
#define REQUEST_MAX (24 + REQUEST_PAYLOAD_MAX + 64 * 16) /* 67 608 */

struct request {
	int32_t type; /* as the client sent it; it may be no enum frame_type */
	uint32_t flags;
	int32_t size, offset;
	uint32_t payload;
	const char *path; /* path_len bytes, without NUL */
	uint32_t path_len;
	const uint8_t *data; /* of a WRITE, at least size bytes */
	uint32_t data_len;
	const uint8_t *tokens; /* of the servers that the request came through, 16 bytes each */
	uint32_t token_count;
};

/*
 * Parse `have` bytes. Returns 0: more bytes are needed, in all *length (24 while that is not
 * known); 1: *request is whole and points into bytes, *length is its length; -EPROTO: this is no
 * request; -EMSGSIZE: the request is too long. After an error the connection cannot be used any
 * more.
 */
int request_parse(const uint8_t *bytes, size_t have, struct request *request, size_t *length);

/*
 * The servers that a request came through. Each owserver appends its token to the requests that it
 * passes on, so that a request which runs in a circle comes to an end. The genuine owserver 3.2
 * clears the first byte of the tokens that it passes on; so owsd ignores that byte, and sends 0 in
 * its own.
 */
struct tokens {
	uint8_t bytes[BUS_TOKENS_MAX * BUS_TOKEN];
	uint32_t count; /* 0: the client is no server */
};

/* A token that no other server has. Never blocks. */
void tokens_own(uint8_t token[BUS_TOKEN]);
/* Did the request come through this server before, or through too many servers to know? */
bool tokens_came_round(const uint8_t *tokens, uint32_t count, const uint8_t token[BUS_TOKEN]);
/* Set the tokens that go with the request to a target, unless the request came here before. */
void tokens_pass(struct tokens *passed, const uint8_t *tokens, uint32_t count,
                 const uint8_t token[BUS_TOKEN]);
