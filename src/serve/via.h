/* SPDX-License-Identifier: MIT */
/*
 * The servers that a request came through. Each owserver puts its token behind what it passes on, so
 * that a request which went round comes to an end. The genuine owserver 3.2 clears the first byte of
 * the tokens that it passes on; so that byte counts for nothing here and is 0 in ours.
 */
#ifndef SERVE_VIA_H
#define SERVE_VIA_H

#include "hal/bus/bus.h"

struct via {
	uint8_t tokens[BUS_TOKENS_MAX * BUS_TOKEN];
	uint32_t count; /* 0: the client is no server */
};

/* A token that no other server has. Never blocks. */
void via_token(uint8_t token[BUS_TOKEN]);
/* Did it come through this server before, or through more of them than can be told? */
bool via_came_round(const uint8_t *tokens, uint32_t count, const uint8_t token[BUS_TOKEN]);
/* What goes with it to a target; it has not come round. */
void via_pass(struct via *via, const uint8_t *tokens, uint32_t count,
              const uint8_t token[BUS_TOKEN]);

#endif
