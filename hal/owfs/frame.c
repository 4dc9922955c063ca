/* SPDX-License-Identifier: MIT */
/* The frames of the owserver protocol, packed and taken apart. */
#include <errno.h>
#include <stdbool.h>
#include <string.h>

#include "hal/owfs/frame.h"

static void put_word(uint8_t *at, uint32_t word)
{
	at[0] = (uint8_t)(word >> 24);
	at[1] = (uint8_t)(word >> 16);
	at[2] = (uint8_t)(word >> 8);
	at[3] = (uint8_t)word;
}

static uint32_t get_word(const uint8_t *at)
{
	return (uint32_t)at[0] << 24 | (uint32_t)at[1] << 16 | (uint32_t)at[2] << 8 | at[3];
}

void frame_put_header(uint8_t bytes[FRAME_HEADER], const struct frame_header *header)
{
	put_word(bytes, header->version);
	put_word(bytes + 4, (uint32_t)header->payload);
	put_word(bytes + 8, (uint32_t)header->type);
	put_word(bytes + 12, header->flags);
	put_word(bytes + 16, (uint32_t)header->size);
	put_word(bytes + 20, (uint32_t)header->offset);
}

void frame_get_header(const uint8_t bytes[FRAME_HEADER], struct frame_header *header)
{
	header->version = get_word(bytes);
	header->payload = (int32_t)get_word(bytes + 4);
	header->type = (int32_t)get_word(bytes + 8);
	header->flags = get_word(bytes + 12);
	header->size = (int32_t)get_word(bytes + 16);
	header->offset = (int32_t)get_word(bytes + 20);
}

int frame_request(uint8_t *out, enum frame_type type, uint32_t flags, int32_t size,
                  const char *path, const uint8_t *data, uint32_t data_len)
{
	size_t path_len = path ? strlen(path) + 1 : 0;
	struct frame_header header = {.type = type, .flags = flags, .size = size};

	if (path_len > FRAME_PATH_MAX + 1 || data_len > FRAME_DATA_MAX)
		return -EMSGSIZE;
	if (type == FRAME_WRITE)
		header.size = (int32_t)data_len;
	header.payload = (int32_t)(path_len + data_len);
	frame_put_header(out, &header);
	if (path_len)
		memcpy(out + FRAME_HEADER, path, path_len);
	if (data_len)
		memcpy(out + FRAME_HEADER + path_len, data, data_len);
	return FRAME_HEADER + header.payload;
}

void frame_set_offset(uint8_t *out, int32_t offset)
{
	put_word(out + 20, (uint32_t)offset);
}

int frame_add_tokens(uint8_t *out, int len, const uint8_t *tokens, uint32_t count)
{
	if (!count)
		return len;
	put_word(out, FRAME_SERVER | count);
	memcpy(out + len, tokens, (size_t)count * FRAME_TOKEN_SIZE);
	return len + (int)(count * FRAME_TOKEN_SIZE);
}

void frame_begin(struct frame_reader *reader, uint8_t *data, uint32_t limit)
{
	reader->data = data;
	reader->limit = limit;
	reader->got = reader->end = 0;
}

static int check_header(struct frame_reader *reader)
{
	struct frame_header *header = &reader->header;
	uint32_t tokens;

	frame_get_header(reader->head, header);
	tokens = header->version & FRAME_TOKENS;
	if (header->version & ~(FRAME_SERVER | FRAME_TOKENS) || tokens > FRAME_TOKENS_MAX ||
	    (tokens && !(header->version & FRAME_SERVER)))
		return -EPROTO;
	if (header->payload < -1)
		return -EPROTO;
	if (header->payload == -1)
		return FRAME_ALIVE;
	if ((uint32_t)header->payload > reader->limit)
		return -EMSGSIZE;
	reader->end = FRAME_HEADER + (uint32_t)header->payload + tokens * FRAME_TOKEN_SIZE;
	return FRAME_MORE;
}

int frame_feed(struct frame_reader *reader, const uint8_t *bytes, size_t n, size_t *used)
{
	*used = 0;
	if (reader->got < FRAME_HEADER) {
		size_t part = FRAME_HEADER - reader->got;
		int state;

		part = n < part ? n : part;
		memcpy(reader->head + reader->got, bytes, part);
		reader->got += (uint32_t)part;
		*used = part;
		if (reader->got < FRAME_HEADER)
			return FRAME_MORE;
		state = check_header(reader);
		if (state == FRAME_ALIVE)
			reader->got = 0;
		if (state != FRAME_MORE)
			return state;
	}
	while (reader->got < reader->end && *used < n) {
		uint32_t data_end = FRAME_HEADER + (uint32_t)reader->header.payload;
		bool is_data = reader->got < data_end;
		size_t part = (is_data ? data_end : reader->end) - reader->got;

		part = n - *used < part ? n - *used : part;
		if (is_data)
			memcpy(reader->data + (reader->got - FRAME_HEADER), bytes + *used, part);
		reader->got += (uint32_t)part;
		*used += part;
	}
	return reader->got == reader->end ? FRAME_WHOLE : FRAME_MORE;
}

/* Far from any offset in a value. The place in the list is what is sent: it never changes. */
#define CAUSE 0x6f777300
static const int causes[] = {-EDOM, -ERANGE, -EBADMSG, -ECOMM};
#define CAUSES (sizeof(causes) / sizeof(causes[0]))

void frame_put_cause(struct frame_header *header, int err, double number)
{
	float bits = (float)number;

	for (size_t i = 0; i < CAUSES; i++)
		if (causes[i] == err)
			header->offset = CAUSE + (int32_t)i;
	if (err == -EDOM)
		memcpy(&header->size, &bits, sizeof(header->size));
}

int frame_cause(const struct frame_header *header, double *number)
{
	int64_t i = (int64_t)header->offset - CAUSE;
	float bits;

	memcpy(&bits, &header->size, sizeof(bits));
	*number = bits;
	return i >= 0 && i < (int64_t)CAUSES ? causes[i] : 0;
}
