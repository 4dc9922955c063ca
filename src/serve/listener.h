/* SPDX-License-Identifier: MIT */
/* Where clients connect: addresses, the unix socket, and who gets a place. */
#ifndef SERVE_LISTENER_H
#define SERVE_LISTENER_H

#include "src/serve/server.h"

/* 0 or a negative errno with the reason in why */
int listeners_open(struct serve *s, char *why, size_t why_size);
void listeners_close(struct serve *s);
/* Take in some of those who wait; false: nobody waits any more, or there is no place for more. */
bool listeners_accept(struct serve *s);

#endif
