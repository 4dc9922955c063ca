/* SPDX-License-Identifier: MIT */
/* The sockets where clients connect, and the admission of clients. */
#pragma once

#include "src/daemon/serve/server.h"

/* Returns 0, or a negative errno with the reason in why. */
int listeners_open(struct serve *s, char *why, size_t why_size);
/*
 * Why nobody can reach listener i now: 0, -EADDRNOTAVAIL, or the error with which it could not be
 * opened again. As serve_absent().
 */
int listeners_look(struct serve *s, unsigned i);
void listeners_close(struct serve *s);
/* Accept some waiting clients; false: no client waits any more, or there is no free place. */
bool listeners_accept(struct serve *s);
