/* SPDX-License-Identifier: MIT */
/* Connections: which get a seat, what was sent over them, and how they end. */
#pragma once

#include "src/memory/control/private.h"

/* Accept some of those that wait; sets accepts and accept_ns. */
void door_accept(struct control *c);
/* Something happened on the connection of the seat. */
void door_event(struct control *c, struct control_seat *p);
/* The process that connected has ended. */
void door_died(struct control *c, struct control_seat *p);
/*
 * Go on with all seats: welcomes to be sent, deadlines, what the engine's thread has done. Returns
 * the time of the next deadline.
 */
int64_t door_look(struct control *c);
/* The controller has to leave: there was no room for it at a reload. */
void door_drop(struct control *c, struct control_seat *p, enum control_counter why);
/* Close and free everything of a seat. */
void door_release(struct control *c, struct control_seat *p);
