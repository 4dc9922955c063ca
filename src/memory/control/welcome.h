/* SPDX-License-Identifier: MIT */
/* What owsd sends over the socket. */
#pragma once

#include "src/memory/control/private.h"

/* Log now and then that the peer is refused with err. */
void welcome_report(struct control *c, const struct peer *peer, enum welcome_deed deed, int err);
/* What stands in that line after "may not". door: the name of the socket. */
void welcome_refusal(enum welcome_deed deed, int err, const char *door, char *text, size_t size);
/*
 * Hang up on so many connections, after a refusal if err is not 0. Returns porter_give(); with keep
 * the first stays open.
 */
int welcome_end(struct control *c, const int *fds, unsigned count, int err, bool keep);
/*
 * Send the controller its memory, and the first time the bell and the news; or later, when the
 * controller has read what was sent before.
 */
void welcome_send(struct control *c, struct control_seat *p);
/* Is there something that the controller has not read, or that the porter has not sent? */
bool welcome_unread(struct control *c, const struct control_seat *p);
