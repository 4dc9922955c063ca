/* SPDX-License-Identifier: MIT */
/* Limit alarms of an item. */
#pragma once

#include "src/config/read/options.h"

struct build;

/* The keys, from the least limit to the greatest. */
extern const enum option limit_options[CONFIG_LIMITS];
/* Its limit alarms, when its type is known. */
void limits_build(struct build *build, const struct option_value *values, struct config_item *item);
