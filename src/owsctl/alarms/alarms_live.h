/* SPDX-License-Identifier: MIT */
/* owsctl alarms: the alarms that stand. */
#pragma once

#include "src/owsctl/ctl.h"

/* The words of `owsctl alarms` that are no patterns; argv[0] is the word. */
#define ALARMS_HISTORY "history"
#define ALARMS_ACK "ack"
#define ALARMS_SHELVE "shelve"
#define ALARMS_UNSHELVE "unshelve"

/* Does each pattern match a signal? If not, prints the error on stderr. */
bool alarms_known(struct ows *h, char *const *patterns, int count);
int alarms_live(struct ctl *ctl, int argc, char **argv);
