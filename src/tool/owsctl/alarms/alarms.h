/* SPDX-License-Identifier: MIT */
/* What the present alarms and the journal of `owsctl alarms` have in common. */
#pragma once

#include "src/tool/owsctl/ctl.h"

/* Does each pattern match a signal? If not, prints the error on stderr. */
bool alarms_known(struct ows *h, char *const *patterns, int count);

/* owsctl alarms history: the journal of owsd's memory, without commands. */
int journal_alarms(struct ctl *ctl, int argc, char **argv);
