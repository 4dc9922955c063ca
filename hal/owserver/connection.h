/* SPDX-License-Identifier: MIT */
/*
 * A connection to one place, by TCP or on a unix socket. Nothing here blocks but through env->wait,
 * up to the deadline given (and the resolver, which knows no deadline). The name is resolved at
 * each connect, so a change of address is followed; all its addresses are tried in turn. A server
 * of this machine has to be one of a trusted user (listener.h).
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "hal/bus/bus.h"

struct addrinfo;

struct connection {
	const struct bus_env *env;
	char host[254]; /* with a slash in front: a unix socket */
	char port[6];
	int fd;                       /* -1: closed */
	struct addrinfo *list, *next; /* while connecting; next is tried after this one */
	int64_t give_up_ns;           /* the present address is tried until then */
	int last_err;                 /* why the last address failed */
	bool stranger;                /* somebody who is not trusted serves one of them */
	char peer[80];                /* "127.0.0.1:4304", once connected or tried */
	char trouble[128];            /* why connecting failed, as a sentence */
};

/*
 * where: `host`, `host:port`, `[v6]`, `[v6]:port`, or the path of a unix socket from the root;
 * empty means localhost. 0, or -EINVAL and why.
 */
int connection_init(struct connection *connection, const struct bus_env *env, const char *where,
                    char *why, size_t why_size);
/* Resolve the name and start to connect. 0, or a negative errno with trouble set. */
int connection_begin(struct connection *connection);
/*
 * Go on until connected (0) or until_ns (-EAGAIN). -ECANCELED: the host shuts down. Other errors:
 * all addresses failed, trouble says how the last one did; nothing is left open.
 */
int connection_go_on(struct connection *connection, int64_t until_ns);
/* connection_begin() and connection_go_on(); -ETIMEDOUT: not connected at until_ns. */
int connection_open(struct connection *connection, int64_t until_ns);
void connection_close(struct connection *connection);
bool connection_is_open(const struct connection *connection);

/*
 * Did the peer close the connection, or send bytes without a request? Then no request may use it.
 */
bool connection_is_stale(const struct connection *connection);
/* 0, -ETIMEDOUT, -ECANCELED, or the socket's error; *sent is set in any case. */
int connection_send(struct connection *connection, const uint8_t *bytes, size_t n, int64_t until_ns,
                    size_t *sent);
/* Returns the bytes received (at least 1), 0: the peer closed, or an error as connection_send(). */
int connection_receive(struct connection *connection, uint8_t *bytes, size_t room,
                       int64_t until_ns);
