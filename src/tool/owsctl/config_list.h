/* SPDX-License-Identifier: MIT */
/* What `owsctl config FILE list` shows of a configuration. */
#pragma once

#include "src/config/read/config.h"
#include "src/tool/owsctl/ctl.h"

/*
 * Show the items whose names match a pattern (without patterns: all), as a table or JSON. Returns
 * the exit status.
 */
int config_list(const struct config *config, char *const *patterns, int count, bool json);
