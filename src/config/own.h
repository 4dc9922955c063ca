/* SPDX-License-Identifier: MIT */
/* Targets that lead back to the owsd that has them. */
#ifndef CONFIG_OWN_H
#define CONFIG_OWN_H

#include <stdbool.h>

struct config;
struct config_report;

/*
 * A target that leads back to this owsd's own server is an error; of auto it is left out, with a
 * warning. 0 or -EINVAL.
 */
int config_check_own(struct config *config, struct config_report *report);
/* Is a target a server of the owserver protocol? */
bool config_has_servers(const struct config *config);

#endif
