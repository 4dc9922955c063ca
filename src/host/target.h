/* SPDX-License-Identifier: MIT */
#ifndef HOST_TARGET_H
#define HOST_TARGET_H

#include <stddef.h>

#include "src/config/config.h"

struct bus;

/*
 * Can owsd make the bus of this target? Nothing is opened but what says what the target is (the
 * file of a simulation). 0, or a negative errno with the reason in why.
 */
int target_check(const char *target, char *why, size_t why_size);
/*
 * Give the bus of target the options of its Bus block; the bus has not been stepped yet. 0, or a
 * negative errno with the option and the reason in why.
 */
int target_options(struct bus *bus, const struct config *config, const char *target, char *why,
                   size_t why_size);
/* Can the targets take their options? Are AlarmLine and HeartbeatLine lines? Errors are said. */
int target_check_options(const struct config *config, struct config_report *report);

#endif
