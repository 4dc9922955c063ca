/* SPDX-License-Identifier: MIT */
/* The alarm of a device: Alarm and the four strings of an item. */
#pragma once

#include "src/config/options.h"

struct build;
struct path;

/* The keys, when the path of the item is known. */
void alarm_build(struct build *build, const struct rio_node *block,
                 const struct option_value *values, const struct path *path,
                 struct config_item *item);
