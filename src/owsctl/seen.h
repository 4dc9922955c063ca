/* SPDX-License-Identifier: MIT */
#ifndef OWSCTL_SEEN_H
#define OWSCTL_SEEN_H

#include "src/owsctl/reading.h"

/*
 * name is the name that was read into reading, with the id. If it is an _Alarm that this user's
 * owsctl has read before, and no alarm came since, its value becomes 0; else it counts as read from
 * now on. Where that cannot be kept the value stays: an alarm is shown twice rather than never.
 */
void seen_alarm(const struct ctl *ctl, struct ows *h, const char *name, int id,
                struct reading *reading);

#endif
