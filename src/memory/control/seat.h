/* SPDX-License-Identifier: MIT */
/* A seat: its descriptors are watched, and it ends. */
#pragma once

#include "src/memory/control/private.h"

/* Have the thread told of fd: of the connection, what 0, or of the end of its process, 1. */
int seat_watch(struct control *c, const struct control_seat *p, int fd, uint32_t what);
/* The engine's thread has to look at the seats. */
void seat_changed(struct control *c);
/* The engine's thread is to part with the controller. */
void seat_leave(struct control *c, struct control_seat *p);
/* The connection ends, once; the seat is free when nobody uses what it had. */
void seat_drop(struct control *c, struct control_seat *p, enum control_counter why);
/* The same with a refusal, which is logged. */
void seat_refuse(struct control *c, struct control_seat *p, int err, enum control_counter why);
/* The process that connected has ended. */
void seat_died(struct control *c, struct control_seat *p);
/* Close and free everything of a seat that nobody uses any more; what cannot go yet, later. */
void seat_release(struct control *c, struct control_seat *p);
