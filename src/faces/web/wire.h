/* SPDX-License-Identifier: MIT */
/*
 * The calls by which libmicrohttpd receives and sends. It closes what a peer has sent along, and
 * sends whatever that costs; it has no hook for either. So recv(), send(), sendmsg() and sendfile()
 * of this program stand in the place of those of the C library: the dynamic linker finds them
 * first. They take only bytes from a unix socket, whose descriptors the porter
 * (src/memory/shm/porter.h) closes, and end a connection whose peer makes them slow
 * (src/ground/service/budget.h).
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define WIRE_FDS 4096 /* a connection has a descriptor below that */
#define WIRE_AWAY 2400

struct log;

/*
 * Before the first thread: starts the porter. The thread that calls this has the connections; in
 * others the calls are those of the C library. 0 or a negative errno.
 */
int wire_open(struct log *log);
/* A connection begins, local: of a unix socket. False: its descriptor is too high. */
bool wire_begin(int fd, bool local, int place);
/* As recv() with MSG_PEEK | MSG_DONTWAIT, or a negative errno; -EBADMSG: with descriptors. */
ptrdiff_t wire_look(int fd, void *bytes, size_t room);
/* Drop what has come, a few times the room. */
void wire_drain(int fd, void *room, size_t size);
/* The connection ends: returns its place. libmicrohttpd closes it when this returns. */
int wire_leave(int fd);
/* Close one that libmicrohttpd does not have. Returns its place. */
int wire_close(int fd);
/* With it goes what waits there. The service manager may have it too, and it stays open there. */
void wire_close_listener(int fd);
/* Give the porter what waits for it, and have it started again if it was killed. */
void wire_run(int64_t now_ns);
/* When wire_run() has to be called at the latest. */
int64_t wire_next(int64_t now_ns);
/* So many wait for the porter that no more connections are to be accepted. */
bool wire_is_full(void);
void wire_end(void);
