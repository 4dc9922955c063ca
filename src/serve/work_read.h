/* SPDX-License-Identifier: MIT */
/* READ: values from the server itself or from a bus, in the units of the client. */
#ifndef SERVE_WORK_READ_H
#define SERVE_WORK_READ_H

#include "src/serve/server.h"

void work_read(struct serve *s, struct client *c);
void work_read_answered(struct serve *s, struct client *c, int err);
/* Convert the value in the room from the bus's units into the client's, and send it. */
void work_show(struct serve *s, struct client *c);

#endif
