/* SPDX-License-Identifier: MIT */
/*
 * The sockets at which a face listens. An address that cannot be had, or that no interface of this
 * machine has, stands in the status and in the report of the face, and is tried again until it can.
 */
#pragma once

#include "src/faces/kit/face.h"

#define LISTENERS (LISTEN_MAX + 1)

struct listeners {
	struct face *face;
	int epoll; /* knows each by its number in fds */
	/* Logs that who reaches that address is served, or is not any more. */
	void (*tell)(struct face *face, const struct listen_address *at, bool served);
	int fds[LISTENERS];                  /* -1: it is shut */
	struct listen_address at[LISTENERS]; /* as it was asked for, where has_address */
	bool has_address[LISTENERS];
	int err[LISTENERS]; /* why nobody is served there; 0: it is served */
	unsigned count;
	int64_t look_ns; /* when to try again */
};

/* A socket that is open already. Takes fd in any case. 0 or a negative errno. */
int listeners_add(struct listeners *l, int fd);
/* Listen at these addresses, and at none of those before that are not among them. */
void listeners_follow(struct listeners *l, const struct listen_address *addresses, unsigned count,
                      int64_t now_ns);
/* Try again what is shut, and look for addresses that come and go; when that is due next. */
int64_t listeners_tick(struct listeners *l, int64_t now_ns);
/* Tell all that are served once more. */
void listeners_tell(const struct listeners *l);
