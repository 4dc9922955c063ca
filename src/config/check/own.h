/* SPDX-License-Identifier: MIT */
/* Targets that lead back to the owsd that has them. */
#pragma once

#include <stdbool.h>

struct config;
struct config_report;

/*
 * Check that no target leads back to this owsd's own server: such a target is an error; a way of
 * auto is left out with a warning. 0 or -EINVAL.
 */
int config_check_own(struct config *config, struct config_report *report);
/* Is a target a server of the owserver protocol? */
bool config_has_servers(const struct config *config);
