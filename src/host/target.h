/* SPDX-License-Identifier: MIT */
#ifndef HOST_TARGET_H
#define HOST_TARGET_H

#include <stddef.h>

#include "src/config/config.h"

struct bus;

/*
 * Can owsd make the bus of this target? Opens nothing but the file that describes a simulation.
 * Returns 0, or a negative errno with the reason in why.
 */
int target_check(const char *target, char *why, size_t why_size);
/*
 * Give the bus of target the options of its Bus block, before the first step of the bus. Returns 0,
 * or a negative errno with the option and the reason in why.
 */
int target_options(struct bus *bus, const struct config *config, const char *target, char *why,
                   size_t why_size);
/*
 * Can the targets take their options, and do AlarmLine and HeartbeatLine name GPIO lines? Errors go
 * to report.
 */
int target_check_options(const struct config *config, struct config_report *report);

#endif
