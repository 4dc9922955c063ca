/* SPDX-License-Identifier: MIT */
/*
 * The connection to owsd's control socket (layout.h, "The socket NAME.control"): hello, and the
 * welcomes with their descriptors. Every wait has a deadline; nothing here raises SIGPIPE.
 */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "src/public/ows_layout.h"

struct join {
	int connection, bell, news; /* descriptors; -1: none */
	/* Of ows_fd(), over all connections: an epoll of the news and the timer; -1: none */
	int epoll, timer;
	bool new;          /* connected, and no welcome has come yet */
	uint8_t token[16]; /* of the last welcome: it outlives the connection */
};

/* When a wait that begins now is over; timeout_ns below 0: never, INT64_MAX. */
static inline int64_t wait_until(int64_t now_ns, int64_t timeout_ns)
{
	return timeout_ns < 0 || timeout_ns > INT64_MAX - now_ns ? INT64_MAX : now_ns + timeout_ns;
}

void join_none(struct join *join);
/*
 * Connect to the socket `file` in a directory, and send the hello with the program's name and
 * OWS_HELLO_ flags. Returns
 * 0; -ENOENT: no owsd listens there; -EACCES; -EAGAIN: too many wait there at the moment.
 */
int join_begin(struct join *join, int directory, const char *file, const char *program,
               uint32_t flags);
/*
 * Receive a welcome, until then at most (by ows_now()). Returns 0 with the descriptor of a memory,
 * which the caller closes; -EAGAIN: none has come; -ENOTCONN: owsd has closed the connection;
 * -EPROTO: what came is no welcome; or the error that stands in the welcome. After an error other
 * than -EAGAIN the connection is closed.
 */
int join_receive(struct join *join, int64_t until_ns, struct ows_welcome *welcome, int *memory);
/* Sleep until the connection has something to receive, or for less; false: the time is over. */
bool join_await(int connection, int64_t until_ns);
/* Make epoll and timer, if there are none. Returns 0 or a negative errno. */
int join_watch(struct join *join);
/* owsd has hung up: close the news, so that epoll is silent but for the timer. */
void join_hush(struct join *join);
/* Close the connection, for another one. */
void join_end(struct join *join);
/* The same, and epoll and timer; in a forked child its parent keeps all. */
void join_leave(struct join *join);
