/* SPDX-License-Identifier: MIT */
/* The tokens of the servers that a request came through. */
#include <string.h>
#include <sys/random.h>
#include <time.h>
#include <unistd.h>

#include "src/serve/via.h"

void via_token(uint8_t token[BUS_TOKEN])
{
	struct timespec t;
	uint64_t mix;

	token[0] = 0;
	if (getrandom(token + 1, BUS_TOKEN - 1, GRND_NONBLOCK) == BUS_TOKEN - 1)
		return;
	/* the clock may be wrong early at boot; the token need not be secret, only different */
	clock_gettime(CLOCK_REALTIME, &t);
	mix = (uint64_t)t.tv_sec * 1000000007u + (uint64_t)t.tv_nsec;
	for (int i = 1; i < BUS_TOKEN; i++) {
		mix = mix * 6364136223846793005u + (uint64_t)getpid();
		token[i] = (uint8_t)(mix >> 56);
	}
}

bool via_came_round(const uint8_t *tokens, uint32_t count, const uint8_t token[BUS_TOKEN])
{
	if (count >= BUS_TOKENS_MAX)
		return true;
	for (uint32_t i = 0; i < count; i++)
		if (memcmp(tokens + i * BUS_TOKEN + 1, token + 1, BUS_TOKEN - 1) == 0)
			return true;
	return false;
}

void via_pass(struct via *via, const uint8_t *tokens, uint32_t count,
              const uint8_t token[BUS_TOKEN])
{
	if (count)
		memcpy(via->tokens, tokens, (size_t)count * BUS_TOKEN);
	memcpy(via->tokens + (size_t)count * BUS_TOKEN, token, BUS_TOKEN);
	via->count = count + 1;
}
