/* SPDX-License-Identifier: MIT */
/* Limit alarms of an item. */
#pragma once

struct build;
struct config_item;
struct option_value;

/* Its limit alarms, when its type is known. */
void limits_build(struct build *build, const struct option_value *values, struct config_item *item);
