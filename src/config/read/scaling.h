/* SPDX-License-Identifier: MIT */
/* What an item's value means: unit and description, scale, filter and range. */
#pragma once

#include <stdbool.h>

struct build;
struct config_item;
struct option_value;

/*
 * These keys of the item, after its InitValue and SafeValue, which have to lie in the range. known:
 * its type is known.
 */
void scaling_build(struct build *build, const struct option_value *values, bool known,
                   struct config_item *item);
