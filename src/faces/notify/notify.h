/* SPDX-License-Identifier: MIT */
/*
 * The face that tells people of alarms: entries of owsd's journal, values that stay bad and alarms
 * that nobody acknowledges become lines of a queue, and messages of it go by mail, POST or command.
 *
 * Room src/faces/notify: the program owsd-notify: tells people of alarms.
 */
#pragma once

#include <stdint.h>
#include <stdio.h>

struct face;
struct face_event;

/* The functions of the face's table. */
int notify_check(const struct face *face);
int notify_start(struct face *face);
void notify_changes(struct face *face, const int *signals, int n);
void notify_event(struct face *face, const struct face_event *event);
void notify_tick(struct face *face, int64_t now_ns);
void notify_report(struct face *face, FILE *out);
void notify_end(struct face *face);
