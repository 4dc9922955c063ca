/* SPDX-License-Identifier: MIT */
/* Which spellings of targets mean the same one, and what a configuration has of it twice. */
#pragma once

#include <stdbool.h>

#include "src/config/read/report.h"
#include "src/config/read/targets.h"

/*
 * The one spelling by which targets of an owserver are compared: "owserver:host:port"; others as
 * they are.
 */
#define TARGET_CANONICAL (TARGET_MAX + 32)
void target_canonical(const char *text, char out[TARGET_CANONICAL]);
/* Do they mean the same target? */
bool target_same(const char *a, const char *b);
/* Where it stands in the file; no file: the command line. */
struct rio_position target_position(const struct config *config,
                                    const struct config_target *target);

/* The Bus block of a target, however it is spelt; NULL: it has none. */
const struct config_bus *config_bus(const struct config *config, const char *target);
/*
 * Report targets and Bus blocks that are given twice, and warn of Bus blocks whose target is not
 * among the configured targets. 0 or -EINVAL.
 */
int config_check_targets(const struct config *config, struct config_report *report);
