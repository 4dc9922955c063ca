/* SPDX-License-Identifier: MIT */
/*
 * The blocks of a configuration by the names that edits have for them: an item's own name;
 * "OwsDrv"; and, where no item is called so, that of a program's block, such as "Web", and
 * "Bus:TARGET".
 */
#pragma once

#include "src/config/read/options.h"

#define EDIT_DRIVER "OwsDrv"
#define EDIT_BUS "Bus:"

/* The driver's block; its first item, rio_next() has the others; one by its name. NULL: none. */
struct rio_node *edit_driver(const struct rio *rio);
struct rio_node *edit_items(const struct rio *rio);
struct rio_node *edit_item(const struct rio *rio, const char *name);
/* Report that there is no such item, with the one whose name is next to it. */
void edit_no_item(const struct rio *rio, const char *name, struct config_report *report);
/* The block of that name, with its kind in *place; NULL after reporting that there is none. */
struct rio_node *edit_block(const struct rio *rio, const char *name, enum option_place *place,
                            struct config_report *report);
/* Make the block, if it is none of an item and not there. 0 or a negative errno of rio_add(). */
int edit_make_block(struct rio **rio, const char *name);
