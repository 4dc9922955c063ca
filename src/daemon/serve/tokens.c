/* SPDX-License-Identifier: MIT */
/* The tokens of the servers that a request came through. */
#include <string.h>
#include <sys/random.h>
#include <unistd.h>

#include "hal/base/time.h"
#include "src/daemon/serve/tokens.h"

void tokens_own(uint8_t token[BUS_TOKEN])
{
	uint64_t mix;

	token[0] = 0;
	if (getrandom(token + 1, BUS_TOKEN - 1, GRND_NONBLOCK) == BUS_TOKEN - 1)
		return;
	/* the clock may be wrong early at boot; the token need not be secret, only different */
	mix = (uint64_t)clock_ns(CLOCK_REALTIME);
	for (int i = 1; i < BUS_TOKEN; i++) {
		mix = mix * 6364136223846793005u + (uint64_t)getpid();
		token[i] = (uint8_t)(mix >> 56);
	}
}

bool tokens_came_round(const uint8_t *tokens, uint32_t count, const uint8_t token[BUS_TOKEN])
{
	if (count >= BUS_TOKENS_MAX)
		return true;
	for (uint32_t i = 0; i < count; i++)
		if (memcmp(tokens + i * BUS_TOKEN + 1, token + 1, BUS_TOKEN - 1) == 0)
			return true;
	return false;
}

void tokens_pass(struct tokens *passed, const uint8_t *tokens, uint32_t count,
                 const uint8_t token[BUS_TOKEN])
{
	if (count)
		memcpy(passed->bytes, tokens, (size_t)count * BUS_TOKEN);
	memcpy(passed->bytes + (size_t)count * BUS_TOKEN, token, BUS_TOKEN);
	passed->count = count + 1;
}
