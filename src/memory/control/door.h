/* SPDX-License-Identifier: MIT */
/* Connections: which get a seat, and how they go on. */
#pragma once

#include "src/memory/control/private.h"

/* Accept some of those that wait; sets accepts and accept_ns. */
void door_accept(struct control *c);
/* Something happened on the connection of the seat. */
void door_event(struct control *c, struct control_seat *p);
/*
 * Go on with all seats: welcomes to be sent, deadlines, what the engine's thread has done. Returns
 * the time of the next deadline.
 */
int64_t door_look(struct control *c);
