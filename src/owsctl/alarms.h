/* SPDX-License-Identifier: MIT */
/* What the words behind `owsctl alarms` do; argv[0] is the word. */
#ifndef OWSCTL_ALARMS_H
#define OWSCTL_ALARMS_H

#include "src/owsctl/verbs.h"

/* Does each pattern match a signal? If not, what was wrong is on stderr. */
bool alarms_known(struct ows *h, char *const *patterns, int count);
int alarms_live(struct ctl *ctl, int argc, char **argv);
int alarms_history(struct ctl *ctl, int argc, char **argv);
int alarms_ack(struct ctl *ctl, int argc, char **argv);

#endif
