/* SPDX-License-Identifier: MIT */
/* What `owsctl config FILE list` shows of a configuration. */
#ifndef OWSCTL_CONFIG_LIST_H
#define OWSCTL_CONFIG_LIST_H

#include "src/config/config.h"
#include "src/owsctl/ctl.h"

/* The items whose names match a pattern (none: all), as a table or JSON. The exit status. */
int config_list(const struct config *config, char *const *patterns, int count, bool json);

#endif
