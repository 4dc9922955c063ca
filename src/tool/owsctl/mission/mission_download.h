/* SPDX-License-Identifier: MIT */
/* The log of a logger's mission, printed. */
#pragma once

#include "src/tool/owsctl/mission/mission_ask.h"

/*
 * The log on stdout, with its progress on the terminal of stderr. CTL_DONE, or CTL_FAILED after
 * printing why.
 */
int mission_download(const struct ctl *ctl, struct mission *mission);
