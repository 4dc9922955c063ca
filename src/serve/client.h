/* SPDX-License-Identifier: MIT */
/* Connections: bytes in, bytes out, time limits. What a request means is not known here. */
#ifndef SERVE_CLIENT_H
#define SERVE_CLIENT_H

#include "src/serve/server.h"

struct client *client_open(struct serve *s, int fd, bool network);
/* What a bus still had of it is back. */
void client_back(struct serve *s, struct client *c);
void client_event(struct serve *s, struct client *c, uint32_t events);
/* Its turn in the round: at most one request. True: c->request is one to work on. */
bool client_turn(struct serve *s, struct client *c);
/* Look at all time limits; sets s->look_ns. */
void clients_look(struct serve *s);
/* In the state from now on; the next time limit counts from here. */
void client_enter(struct serve *s, struct client *c, enum client_state state);
/* Close the one that is idle for longest, if that is long; else s->look_ns is when it will be. */
bool client_evict(struct serve *s);
/* What is sent from now on. */
void client_send(struct serve *s, struct client *c, const uint8_t *bytes, uint32_t len);
/* Where the data of an answer go, behind room for its header. */
uint8_t *client_room(struct client *c);
uint32_t client_room_size(struct client *c);

#endif
