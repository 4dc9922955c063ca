/* SPDX-License-Identifier: MIT */
/* owsctl alarms history: the journal. */
#ifndef OWSCTL_ALARMS_HISTORY_H
#define OWSCTL_ALARMS_HISTORY_H

struct ctl;

int alarms_history(struct ctl *ctl, int argc, char **argv);

#endif
