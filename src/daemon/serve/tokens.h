/* SPDX-License-Identifier: MIT */
/*
 * The servers that a request came through. Each owserver appends its token to the requests that it
 * passes on, so that a request which runs in a circle comes to an end. The genuine owserver 3.2
 * clears the first byte of the tokens that it passes on; so owsd ignores that byte, and sends 0 in
 * its own.
 */
#pragma once

#include "hal/bus/bus.h"

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
