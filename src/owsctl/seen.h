/* SPDX-License-Identifier: MIT */
#ifndef OWSCTL_SEEN_H
#define OWSCTL_SEEN_H

#include "src/owsctl/ctl.h"
#include "src/show/reading.h"

/*
 * name is the name that was read into reading, with the id. If the name is an _Alarm that this
 * user's owsctl has read before, and no alarm came since, the value becomes 0; else the alarm
 * counts as read from now on. Where owsctl cannot keep that, the value stays: the user sees an
 * alarm twice rather than never.
 */
void seen_alarm(const struct ctl *ctl, struct ows *h, const char *name, int id,
                struct reading *reading);

#endif
