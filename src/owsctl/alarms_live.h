/* SPDX-License-Identifier: MIT */
/* owsctl alarms: the alarms that stand. */
#ifndef OWSCTL_ALARMS_LIVE_H
#define OWSCTL_ALARMS_LIVE_H

#include "src/owsctl/ctl.h"

/* The words that `owsctl alarms` takes for no pattern; argv[0] is the word. */
#define ALARMS_HISTORY "history"
#define ALARMS_ACK "ack"

/* Does each pattern match a signal? If not, what was wrong is on stderr. */
bool alarms_known(struct ows *h, char *const *patterns, int count);
int alarms_live(struct ctl *ctl, int argc, char **argv);

#endif
