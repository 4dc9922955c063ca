/* SPDX-License-Identifier: MIT */
/*
 * DIR and its kin: the names come from the targets or from the server, and go to a client.
 * STEP_BUSES only looks for the buses of the targets. A function that returns true has ended such a
 * look: the client's request goes on.
 */
#pragma once

#include "src/daemon/serve/server.h"

bool work_want_directory(struct serve *s, struct client *c, enum client_step step);
/* The engine has answered. */
bool work_listed(struct serve *s, struct client *c, int err);
/* Does a client wait for a directory, and is one free? */
bool work_waits(struct serve *s);
/* The client that has waited longest begins. NULL: no client waits, or no directory is free. */
struct client *work_unqueue(struct serve *s, bool *ended);
