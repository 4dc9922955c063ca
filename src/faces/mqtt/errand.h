/* SPDX-License-Identifier: MIT */
/*
 * An errand: what somebody asks at the broker, and another program of this machine has to answer,
 * at its socket in the directory of owsd's files. One at a time, in the loop of the face.
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "src/faces/mqtt/ask.h"
#include "src/faces/mqtt/client.h"

enum errand_kind {
	ERRAND_NONE,
	ERRAND_DEVICES, /* for owsd: which devices are there? */
	ERRAND_RENAME,  /* for owsd-writer: another name for a signal */
};

/* All zero: none. */
struct errand {
	enum errand_kind kind;
	int fd;
	int64_t until_ns;
	char *got; /* what came, with NUL behind it */
	size_t len, room;
	/* Who asked: the members that an answer needs, copied */
	struct broker_message message;
	struct ask ask;
	char name[TOPIC_SIZE]; /* of a signal */
};

/*
 * Connect to NAME.what of the instance that face has open, and send the bytes. name, message: what
 * the errand keeps, for the answer. 0 with errand->kind set; -EBUSY: another is under way; -EACCES,
 * -ENOENT, -ECONNREFUSED: as connect(2); or another negative errno.
 */
int errand_begin(struct errand *errand, enum errand_kind kind, struct face *face, const char *what,
                 const void *bytes, size_t len, const char *name,
                 const struct broker_message *message);
/* fd is ready. True: it is that of the errand, and the other side has sent all. */
bool errand_ready(struct errand *errand, int fd);
/* Its time is over: what came is all that comes. */
bool errand_late(const struct errand *errand, int64_t now_ns);
void errand_end(struct errand *errand, struct face *face);
