/* SPDX-License-Identifier: MIT */
/*
 * Editing a configuration as the manual's dialog does (figures 3.1 and 3.2), key by key, over the
 * document: comments, order and spelling of everything else stay.
 *
 * Settings are "KEY=VALUE". Type, IO and Uncached go into the bits of IOType where an item has
 * that. Errors go to report. Returns 0, -EINVAL (reported), -ENOMEM or -EFBIG.
 */
#pragma once

#include "src/config/read/rio.h"

/* Add an item at the end; an input of type double unless the settings give something else. */
int edit_add(struct rio **rio, const char *name, const char *path, const char *const *settings,
             unsigned count, struct config_report *report);
/*
 * Change an item, or the driver's own keys: name "OwsDrv"; or, if no item is called so, those of
 * a block: that of a program, such as "Web", or "Bus:TARGET", which is made if there is none.
 */
int edit_set(struct rio **rio, const char *name, const char *const *settings, unsigned count,
             struct config_report *report);
/*
 * Give an item another name, as edit_set() with Name=TO does. What names it elsewhere follows: a
 * ControlAllow of that one signal. Warns of patterns that fit only one of the two names.
 */
int edit_rename(struct rio **rio, const char *name, const char *to, struct config_report *report);
/* Remove keys, so that they are not defined. */
int edit_unset(struct rio **rio, const char *name, const char *const *keys, unsigned count,
               struct config_report *report);
/* Remove an item, or one of these blocks; not the driver's. */
int edit_remove(struct rio **rio, const char *name, struct config_report *report);
/* Put an item, with the comment lines directly above it, before another or after it. */
int edit_move(struct rio **rio, const char *name, const char *other, bool behind,
              struct config_report *report);
/* Correct ItemCount, where the file has that key, to the number of items. */
int edit_count(struct rio **rio);

/* The text of a configuration without items. */
extern const char edit_empty[];
