/* SPDX-License-Identifier: MIT */
/*
 * Connections of clients: bytes in, bytes out, time limits. The meaning of requests is elsewhere.
 */
#pragma once

#include "src/daemon/serve/server.h"

/*
 * A new connection has the next free place. Its request is mostly there by now: the server reads it
 * before epoll learns of the connection.
 */
void client_open(struct serve *s, int fd, const struct listener *from,
                 const struct sockaddr_in6 *peer);
/* Have epoll report on the connection, if it is open and epoll does not yet. */
void client_watch(struct serve *s, struct client *c);
/* Count and log a connection that was closed at once. */
void client_refused(struct serve *s, enum serve_counter what, struct log_rate *rate,
                    const char *reason);
/* The engine and the buses have returned all memory of the client that they used. */
void client_back(struct serve *s, struct client *c);
void client_event(struct serve *s, struct client *c, uint32_t events);
/* The client's turn in the round: at most one request. True: c->request waits to be worked on. */
bool client_turn(struct serve *s, struct client *c);
/*
 * Receive from a client whose request may be there by now, before epoll says so. True: some bytes
 * are, and the client is in the round.
 */
bool client_again(struct serve *s, struct client *c);
/* Apply the time limits of all clients; sets s->look_ns. */
void clients_look(struct serve *s);
/* Enter a state; its time limit counts from now. */
void client_enter(struct serve *s, struct client *c, enum client_state state);
/* Close the client that is idle for longest, if for EVICT_NS; else set s->look_ns to that time. */
bool client_evict(struct serve *s);
/* Set the bytes that are sent from now on. */
void client_send(struct serve *s, struct client *c, const uint8_t *bytes, uint32_t len);
/* The place for the data of an answer, after the room for the answer's header. */
uint8_t *client_room(struct client *c);
uint32_t client_room_size(struct client *c);

/*
 * Close a connection. One of a unix socket the porter closes: what lies unread there may have
 * descriptors with it.
 */
void client_part(struct serve *s, int fd, bool network);
/* Give the porter those that it has not taken yet. */
void clients_away(struct serve *s);
