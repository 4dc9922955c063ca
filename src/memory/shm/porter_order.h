/* SPDX-License-Identifier: MIT */
/* What the porter is asked to do. */
#pragma once

#include <stdint.h>
#include <sys/uio.h>

/* Each has children of its own, and is used by one thread at a time. */
enum porter_lane {
	PORTER_AWAY,   /* connections that end */
	PORTER_IN,     /* welcomes */
	PORTER_SERVED, /* clients of the served protocol that end */
	PORTER_MEMORY, /* what controllers had */
	PORTER_NEWS,   /* sleepers of an image, pipes of controllers */
	PORTER_LANES,
};

#define PORTER_FDS 64
#define PORTER_BYTES 320
#define PORTER_SLOTS (128 + 1024) /* connections, and memories to empty */
#define PORTER_NO_SLOT UINT32_MAX

enum porter_what {
	PORTER_SEND = 1, /* the bytes over fds[0], with copies of the other descriptors */
	/* shut fds[0] down, and receive what lies there unless it hurts */
	PORTER_HANG_UP = 2,
	/* wake all that sleep on the news of the image fds[0] */
	PORTER_WAKE = 8,
	/* free the pages of the file fds[0] */
	PORTER_EMPTY = 16,
	PORTER_EACH = 4 /* that with each descriptor, as all are connections */
};

struct porter_order {
	unsigned what;  /* bits of enum porter_what; in any case the child lets all go */
	unsigned count; /* of descriptors, from 1 */
	uint64_t keep;  /* bits of the descriptors that stay open here too */
	uint32_t slot;  /* for porter_carried(); PORTER_NO_SLOT: none */
	int fds[PORTER_FDS];
	struct iovec bytes; /* at most PORTER_BYTES */
};
