/* SPDX-License-Identifier: MIT */
/* Answers of the served protocol, made in a client's area and sent. */
#include <string.h>

#include "hal/owfs/frame.h"
#include "src/daemon/serve/answer.h"
#include "src/daemon/serve/client.h"

/* The answer's payload bytes are in client_room(). */
static void answer_data(struct serve *s, struct client *c, int32_t ret, uint32_t payload,
                        uint32_t size, int32_t offset)
{
	struct frame_header h = {.payload = (int32_t)payload,
	                         .type = ret,
	                         .flags = c->request.flags,
	                         .size = (int32_t)size,
	                         .offset = offset};
	uint8_t *data = client_room(c);

	if (ret < 0)
		count(s, COUNT_errors, 1);
	frame_put_header(data - FRAME_HEADER, &h);
	client_send(s, c, data - FRAME_HEADER, FRAME_HEADER + payload);
}

void answer_code(struct serve *s, struct client *c, int32_t code)
{
	answer_data(s, c, code, 0, 0, 0);
}

void answer_error(struct serve *s, struct client *c, int err)
{
	struct frame_header h = {0};

	frame_put_cause(&h, err, c->guest.answer.number);
	answer_data(s, c, code_of(err), 0, (uint32_t)h.size, h.offset);
}

void answer_value(struct serve *s, struct client *c, uint32_t len)
{
	uint32_t offset = (uint32_t)c->request.offset, size = (uint32_t)c->request.size;
	uint8_t *data = client_room(c);

	if (c->request.offset < 0 || offset >= len) {
		answer_data(s, c, 0, 0, 0, 0);
		return;
	}
	len -= offset;
	if (size < len)
		len = size;
	if (offset)
		memmove(data, data + offset, len);
	answer_data(s, c, (int32_t)len, len, len, (int32_t)offset);
}

void answer_written(struct serve *s, struct client *c, uint32_t taken)
{
	answer_data(s, c, 0, 0, taken, 0);
}

void answer_id(struct serve *s, struct client *c, const uint8_t rom[ROM_LEN])
{
	memcpy(client_room(c), rom, ROM_LEN);
	answer_data(s, c, 0, ROM_LEN, 0, 0);
}
