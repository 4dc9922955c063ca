/* SPDX-License-Identifier: MIT */
/*
 * The frames of the owserver protocol: six big-endian 32-bit words, then data. Pure functions,
 * no input or output. Every length is checked before it is used.
 */
#pragma once

#include <stddef.h>
#include <stdint.h>

#define FRAME_HEADER 24
/* The longest path (its NUL not counted) and the most data that are sent. */
#define FRAME_PATH_MAX 1023
#define FRAME_DATA_MAX 65536
#define FRAME_REQUEST_MAX (FRAME_HEADER + FRAME_PATH_MAX + 1 + FRAME_DATA_MAX)

enum frame_type {
	FRAME_NOP = 1,
	FRAME_READ = 2,
	FRAME_WRITE = 3,
	FRAME_DIR = 4, /* a reply for each entry, and an empty one */
	FRAME_PRESENT = 6,
	FRAME_DIRALL = 7,
	FRAME_GET = 8,         /* READ or DIRALL, by what is there */
	FRAME_DIRALLSLASH = 9, /* directories end with '/' */
	FRAME_GETSLASH = 10,
};

#define FRAME_BUS_LIST UINT32_C(0x02) /* list bus.N, settings and the like in the root */
#define FRAME_PERSIST UINT32_C(0x04)  /* keep the connection; cleared in the reply: refused */
#define FRAME_UNCACHED UINT32_C(0x20)
#define FRAME_TRIM UINT32_C(0x40) /* numbers without padding */
/* Scales and the format of device names, as numbers. */
#define FRAME_TEMPERATURE(flags) ((flags) >> 16 & 3)
#define FRAME_PRESSURE(flags) ((flags) >> 18 & 7)
#define FRAME_FORMAT(flags) ((flags) >> 24)

/* Of the version word: sent by an owserver, and then the number of tokens behind the data. */
#define FRAME_SERVER UINT32_C(0x10000)
#define FRAME_TOKENS UINT32_C(0x0ffff)
#define FRAME_TOKEN_SIZE 16
#define FRAME_TOKENS_MAX 64
/* As many are sent at most; a chain of servers that long has no use. */
#define FRAME_TOKENS_SENT 8

struct frame_header {
	uint32_t version;
	int32_t payload; /* bytes of data; -1 in a reply: keep-alive */
	int32_t type;    /* of a reply: return code, negative when it failed */
	uint32_t flags;
	int32_t size;
	int32_t offset;
};

void frame_put_header(uint8_t bytes[FRAME_HEADER], const struct frame_header *header);
void frame_get_header(const uint8_t bytes[FRAME_HEADER], struct frame_header *header);

/*
 * Owsd's replies of -EIO to a READ have the precise error in offset, of -EDOM also the number in
 * size; the replies of others have 0 there, and clients look at neither. err is -EDOM, -ERANGE,
 * -EBADMSG or -ECOMM; others leave the header as it is, and are 0.
 */
void frame_put_cause(struct frame_header *header, int err, double number);
int frame_cause(const struct frame_header *header, double *number);

/*
 * Make a whole request in out, which has room for FRAME_REQUEST_MAX. path NULL: none (NOP). size
 * is what a READ asks for; a WRITE's is data_len. Returns its length, or -EMSGSIZE.
 */
int frame_request(uint8_t *out, enum frame_type type, uint32_t flags, int32_t size,
                  const char *path, const uint8_t *data, uint32_t data_len);
/* Where in the value a request's data begin; 0 if it is not said. */
void frame_set_offset(uint8_t *out, int32_t offset);
/*
 * Put the tokens of count servers, up to FRAME_TOKENS_SENT, behind a request of len bytes; out has
 * room for FRAME_TOKENS_SENT * FRAME_TOKEN_SIZE more. Returns the new length.
 */
int frame_add_tokens(uint8_t *out, int len, const uint8_t *tokens, uint32_t count);

/* A reply, put together from fragments of any size. */
struct frame_reader {
	uint8_t head[FRAME_HEADER];
	struct frame_header header; /* valid when a frame is whole */
	uint8_t *data;              /* header.payload bytes, lent by the caller */
	uint32_t limit;             /* the most data it takes */
	uint32_t got, end;          /* bytes that came; of the whole frame, 0 unknown */
};

enum frame_state {
	FRAME_MORE,  /* all was used, the frame is not whole */
	FRAME_ALIVE, /* a keep-alive frame was taken away */
	FRAME_WHOLE, /* the reply is whole */
};

void frame_begin(struct frame_reader *reader, uint8_t *data, uint32_t limit);
/*
 * Take n bytes, at most up to the end of the frame; *used says how many. Returns a frame_state, or
 * -EPROTO: not an owserver's frame, -EMSGSIZE: data longer than limit.
 */
int frame_feed(struct frame_reader *reader, const uint8_t *bytes, size_t n, size_t *used);
