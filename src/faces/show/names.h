/* SPDX-License-Identifier: MIT */
/* Names as the user writes them: their signals, patterns, and the nearest name of the table. */
#pragma once

#include <stdbool.h>

#include "src/ground/signal/attribute.h"
#include "src/public/ows.h"

#define NAMES_MAX (SIGNAL_NAME_MAX + 32)

/* Signal (-1: the driver) and attribute of a name; -ENOENT. */
int names_lookup(struct ows *h, const char *instance, const char *name, int *signal,
                 enum attribute *attribute);

/* Is it the name of a signal's value? Then *info is of that signal. */
bool names_info(struct ows *h, const char *instance, const char *name, struct ows_info *info);

/* Does one of count patterns (fnmatch) match, or is there none? */
bool names_match(const char *name, char *const *patterns, int count);
/* Does a signal match? */
bool names_some(struct ows *h, char *const *patterns, int count);

/* The name that the user probably meant; false if no name is near. */
bool names_nearest(struct ows *h, const char *name, char nearest[NAMES_MAX]);
