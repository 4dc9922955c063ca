/* SPDX-License-Identifier: MIT */
/*
 * DIR and its kin: names from the targets, or from here, on their way to a client. STEP_BUSES looks
 * for the buses behind the targets alone. The functions that return true say that such a look has
 * ended: the client's request goes on.
 */
#ifndef SERVE_WORK_DIRECTORY_H
#define SERVE_WORK_DIRECTORY_H

#include "src/serve/server.h"

bool work_want_directory(struct serve *s, struct client *c, enum client_step step);
/* The engine has answered. */
bool work_listed(struct serve *s, struct client *c, int err);
/* Clients that wait for a directory: is one free? */
bool work_waits(struct serve *s);
/* The client that has waited longest begins. NULL: nobody waits, or no directory is free. */
struct client *work_unqueue(struct serve *s, bool *ended);

#endif
