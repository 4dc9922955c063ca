/* SPDX-License-Identifier: MIT */
/* owsctl alarms history: the journal of owsd's memory, without commands. */
#pragma once

#include "src/tool/owsctl/ctl.h"

int journal_alarms(struct ctl *ctl, int argc, char **argv);
