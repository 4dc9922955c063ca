/* SPDX-License-Identifier: MIT */
/*
 * The face that pushes: lines wait in memory, and go as a batch each few seconds; what a server has
 * missed comes from the history of owsd-recorder. One batch at a time is under way.
 *
 * Room src/faces/influx: the program owsd-influx: pushes signals to a server.
 */
#pragma once

#include <stdint.h>
#include <stdio.h>

struct face;
struct face_event;

/* The functions of the face's table; face->own is the pushing. */
int pushing_open(struct face *face);
void pushing_changes(struct face *face, const int *signals, int n);
void pushing_event(struct face *face, const struct face_event *event);
void pushing_tick(struct face *face, int64_t now_ns);
void pushing_close(struct face *face);
/* Writes what keeps it from pushing. */
void pushing_report(struct face *face, FILE *out);
