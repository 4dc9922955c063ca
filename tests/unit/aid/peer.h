/* SPDX-License-Identifier: MIT */
/*
 * An owserver to test against: a thread on a loopback port that answers a few paths, and each
 * request (greetings, NOP and the names of its buses, are not counted) as the next letter of its
 * plan says; 'a' when it is over.
 *   a answer             r answer, refuse persistence, close     c answer, then close
 *   k 3 keep-alives, then answer     K keep-alives every 0.1 s until the client goes
 *   f answer byte by byte            t answer and 3 bytes more   l answer with more than asked for
 *   x close instead of an answer     R reset instead             m half of an answer, then close
 *   D answer, and again when the test has set repeat by peer_repeat()
 *   s silence until the client goes  d half of an answer, then silence
 *   z first of the plan: the names of its buses come 1.5 s late, and the rest follows
 *   g garbage     h payload 2 GB     n payload -5     v version 0x20000     w less than it says
 *   W more than it says
 */
#pragma once

#include <pthread.h>
#include <stdbool.h>
#include <stdint.h>

struct peer {
	int listen_fd, family;
	int hold_fd; /* keeps the port while nobody listens on it */
	uint16_t port;
	char path_of_socket[40];
	const char *plan;
	char target[80];
	pthread_t thread;
	int stopping;
	/* What the peer saw; read with peer_saw(). */
	unsigned connections, requests, greetings, writes;
	unsigned repeat;       /* set by peer_repeat() */
	unsigned done, closed; /* requests done by the plan; connections that the peer closed */
	uint32_t flags;        /* of the last request */
	int32_t size;
	char path[256];
};

/* Set before the peer starts: its adapter does not call itself a simulation. */
extern bool peer_has_a_wire;
/* family AF_INET, AF_INET6 or AF_UNIX; plan has to stay. Fails the test when there is no port. */
void peer_start(struct peer *peer, int family, const char *plan);
void peer_stop(struct peer *peer);
/* Close the connection and serve no more, but go on listening until peer_stop(). */
void peer_leave(struct peer *peer);
/* Free the port of a stopped peer. */
void peer_end(struct peer *peer);
/* Start again on the same port after peer_stop(). */
void peer_restart(struct peer *peer, const char *plan);
unsigned peer_saw(const unsigned *count);
/* The answer of a D goes out once more. */
void peer_repeat(struct peer *peer);
