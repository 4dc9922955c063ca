/* SPDX-License-Identifier: MIT */
/* The parser of requests of the owserver protocol. */
#include <errno.h>
#include <string.h>
#include <sys/random.h>
#include <unistd.h>

#include "hal/base/time.h"
#include "hal/owfs/frame.h"
#include "src/daemon/serve/request.h"

static uint32_t tokens_of(const struct frame_header *h)
{
	return h->version & FRAME_SERVER ? h->version & FRAME_TOKENS : 0;
}

static int check_header(const struct frame_header *h, size_t *length)
{
	uint32_t tokens = tokens_of(h);

	if (h->version & ~(FRAME_SERVER | FRAME_TOKENS) || tokens > FRAME_TOKENS_MAX ||
	    h->payload < 0)
		return -EPROTO;
	if (h->payload > REQUEST_PAYLOAD_MAX)
		return -EMSGSIZE;
	if (h->type == FRAME_WRITE && (h->size < 0 || h->size > h->payload))
		return -EPROTO;
	*length = FRAME_HEADER + (size_t)h->payload + tokens * FRAME_TOKEN_SIZE;
	return 0;
}

int request_parse(const uint8_t *bytes, size_t have, struct request *request, size_t *length)
{
	struct frame_header h;
	const uint8_t *nul;
	int err;

	*length = FRAME_HEADER;
	if (have < FRAME_HEADER)
		return 0;
	frame_get_header(bytes, &h);
	err = check_header(&h, length);
	if (err || have < *length)
		return err;
	*request = (struct request){
		.type = h.type,
		.flags = h.flags,
		.size = h.size,
		.offset = h.offset,
		.payload = (uint32_t)h.payload,
		.path = (const char *)bytes + FRAME_HEADER,
		.path_len = (uint32_t)h.payload,
		.tokens = bytes + FRAME_HEADER + h.payload,
		.token_count = tokens_of(&h),
	};
	/* owrust sends no NUL between path and data: the size states where they part */
	if (h.type == FRAME_WRITE) {
		request->path_len -= (uint32_t)h.size;
		request->data = (const uint8_t *)request->path + request->path_len;
		request->data_len = (uint32_t)h.size;
	}
	nul = request->path_len ? memchr(request->path, '\0', request->path_len) : NULL;
	if (nul) {
		request->path_len = (uint32_t)(nul - (const uint8_t *)request->path);
		request->data = nul + 1;
		request->data_len = request->payload - request->path_len - 1;
	}
	return 1;
}

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
