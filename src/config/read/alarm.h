/* SPDX-License-Identifier: MIT */
/* The alarm of a device: Alarm and the four strings of an item. */
#pragma once

#include "hal/owfs/path.h"
#include "src/config/read/options.h"

struct build;

#define ALARM_PATH (PATH_LEN_MAX + 64)

/*
 * The path of the property that a string of the item's alarm names, up to an '='. Returns the
 * property in it, NULL: none, or the path of the item names no device.
 */
const char *alarm_path(const struct config_item *item, const char *string, char path[ALARM_PATH]);

/* The keys, when the path of the item is known. */
void alarm_build(struct build *build, const struct rio_node *block,
                 const struct option_value *values, const struct path *path,
                 struct config_item *item);
