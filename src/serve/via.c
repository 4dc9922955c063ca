/* SPDX-License-Identifier: MIT */
#include "via.h"

#include <errno.h>
#include <string.h>
#include <sys/random.h>

int via_token(uint8_t token[BUS_TOKEN])
{
	token[0] = 0;
	if (getrandom(token + 1, BUS_TOKEN - 1, GRND_NONBLOCK) != BUS_TOKEN - 1)
		return errno ? -errno : -EAGAIN;
	return 0;
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
