/* SPDX-License-Identifier: MIT */
/* The process of the porter, and what passes between it and owsd. Private to porter.c. */
#pragma once

#include <sys/socket.h>

#include "src/memory/shm/porter_order.h"

struct porter_head {
	uint32_t sequence, what, slot;
};

/* Both sides have it. */
struct porter_shared {
	uint32_t given[PORTER_LANES]; /* owsd has closed its own copies up to this order */
	uint32_t carried[PORTER_SLOTS];
	uint32_t ready; /* the process that has closed what is not its own */
};

union porter_attached {
	struct cmsghdr align;
	char room[CMSG_SPACE(PORTER_FDS * sizeof(int))];
};

struct porter_message {
	struct porter_head head;
	struct iovec parts[2];
	struct msghdr header;
};

/* Of an order: the head, the bytes behind it, and the descriptors, for which control has room. */
void porter_lay_out(struct porter_message *message, struct iovec bytes);
void porter_attach(struct msghdr *header, union porter_attached *control, const int *fds,
                   unsigned count);
/* What an order asks, by the thread that calls. */
void porter_carry_out(unsigned what, const int *fds, unsigned count, struct iovec bytes);
/* After a fork: be the porter of these lanes, and end with them. */
_Noreturn void porter_main(const int *lanes, struct porter_shared *shared);
