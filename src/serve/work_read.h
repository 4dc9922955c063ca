/* SPDX-License-Identifier: MIT */
/* READ: from what is known here, or from a bus, in the units of the client. */
#ifndef SERVE_WORK_READ_H
#define SERVE_WORK_READ_H

#include "src/serve/server.h"

void work_read(struct serve *s, struct client *c);
void work_read_answered(struct serve *s, struct client *c, int err);
/* The value is in the room as the bus gave it: into the client's units, and out. */
void work_show(struct serve *s, struct client *c);

#endif
