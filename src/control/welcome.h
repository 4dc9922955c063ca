/* SPDX-License-Identifier: MIT */
/* What owsd sends over the socket. */
#ifndef CONTROL_WELCOME_H
#define CONTROL_WELCOME_H

#include "src/control/private.h"

/* Refuse with err, and log that now and then. Never blocks; what cannot be sent is not sent. */
void welcome_refuse(struct control *c, int fd, const struct peer *peer, int err);
/*
 * Send the giver its memory, and the first time the bell and the news. 0: done, or later: when the
 * giver has read what was sent before; else a negative errno.
 */
int welcome_send(struct control_place *p);
/* Is there something that the giver has not read? */
bool welcome_unread(const struct control_place *p);

#endif
