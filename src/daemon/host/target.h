/* SPDX-License-Identifier: MIT */
#pragma once

#include <stddef.h>

#include "src/config/read/config.h"

struct bus;

/*
 * Give the bus of target the options of its Bus block, before the first step of the bus. Returns 0,
 * or a negative errno with the option and the reason in why.
 */
int target_options(struct bus *bus, const struct config *config, const char *target, char *why,
                   size_t why_size);
/*
 * Check a configuration as owsd does at its start: can owsd make the buses of its targets, do they
 * take their options, do AlarmLine and HeartbeatLine name GPIO lines; then config_check(). Opens
 * nothing but the files that describe simulations. 0, or a negative errno with errors in report. Of
 * a configuration that has errors by the report already, its items alone are checked.
 */
int target_check_config(struct config *config, struct config_report *report);

/*
 * Warn of targets and GPIO lines with a device, socket or master that is not on this machine now:
 * owsd would wait for it. What is there and can never be it is an error. Opens GPIO chips alone.
 * For a check of a file where it is used. 0 or -EINVAL.
 */
int target_look(const struct config *config, struct config_report *report);
