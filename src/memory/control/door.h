/* SPDX-License-Identifier: MIT */
/* Connections: which get a place, what was sent over them, and how they end. */
#pragma once

#include "src/memory/control/private.h"

/* Accept some of those that wait; sets accepts and accept_ns. */
void door_accept(struct control *c);
/* Something happened on the connection of the place. */
void door_event(struct control *c, struct control_place *p);
/* The process that connected has ended. */
void door_died(struct control *c, struct control_place *p);
/*
 * Go on with all places: welcomes to be sent, deadlines, what the engine's thread has done. Returns
 * the time of the next deadline.
 */
int64_t door_look(struct control *c);
/* The controller has to leave: there was no room for it at a reload. */
void door_drop(struct control *c, struct control_place *p, enum control_counter why);
/* Close and free everything of a place. */
void door_release(struct control *c, struct control_place *p);
