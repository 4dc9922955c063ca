/* SPDX-License-Identifier: MIT */
/*
 * The doors: sockets at which owsd-web listens. A connection waits here until the head of its
 * request is whole and right; then libmicrohttpd gets it. Each connection has one request.
 */
#pragma once

#include <stdbool.h>
#include <stdint.h>
#include <sys/socket.h>

#include "src/faces/kit/listeners.h"
#include "src/faces/web/crowd.h"
#include "src/ground/service/listen.h"

#define DOORS_CONNECTIONS CROWD
#define DOORS_PER_PEER 64 /* of one user at a socket, or one TCP address */
#define DOORS_IDLE_S 30

struct visitor;

struct doors {
	int64_t came_ns; /* what epoll reports now came later than that */
	int64_t head_ns; /* and the head of the visitor who is let in */
	int epoll;       /* readable when doors_take() has something to do; -1: not open */
	struct listeners listeners;
	struct visitor *visitors; /* DOORS_CONNECTIONS */
	unsigned visitor_count;
	int64_t paused_ns;  /* no descriptor was left: listen again then; 0: it listens */
	int64_t watched_ns; /* epoll has all doors since then; INT64_MAX: they pause */
	struct crowd crowd;
	char path[108]; /* of the socket, to remove at the end; "": the manager's */
	struct listen_file file;
	/* Takes a connection and closes it at the end. count: how many it has already. */
	void (*welcome)(void *ctx, int fd, const struct sockaddr *address, socklen_t len);
	unsigned (*count_inside)(void *ctx);
	bool (*is_proxy)(void *ctx, int fd);
	void *ctx;
};

/* Before the others; the functions, ctx, face and tell are set. 0 or a negative errno. */
int doors_open(struct doors *doors);
/* Listen: at the sockets of LISTEN_FDS (sd_listen_fds(3)); how many, or a negative errno. */
int doors_inherit(struct doors *doors);
/* At a path, with mode 0660, in place of a socket that nobody answers. -EADDRINUSE. */
int doors_socket(struct doors *doors, const char *path);
/* At that time epoll had nothing to report: what comes now came later. */
void doors_empty(struct doors *doors, int64_t looked_ns);
/* Accept, read heads, refuse. Never blocks. */
void doors_take(struct doors *doors, int64_t now_ns);
/* One that was welcomed ends: its place is free. welcome's taker closes it when this returns. */
void doors_leave(struct doors *doors, int fd);
/* When doors_take() has to be called at the latest. */
int64_t doors_next(const struct doors *doors);
void doors_close(struct doors *doors);
