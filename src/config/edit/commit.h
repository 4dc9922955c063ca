/* SPDX-License-Identifier: MIT */
/* A document that was edited is checked, and takes the place of its file. */
#pragma once

#include "src/config/read/config.h"
#include "src/config/read/rio.h"

/*
 * Lock file against other edits; call it before reading the file. Returns a descriptor for
 * replace_unlock() after the commit, or a negative errno (reported). Blocking, five seconds at
 * most.
 */
int edit_lock(const char *file, struct config_report *report);

/*
 * Check the document, then put it in the place of file in one step: a temporary file beside it,
 * with the same owner and mode, written out and renamed. A symbolic link stays and its target is
 * replaced. When something fails, the old file is untouched. 0, -EINVAL (the check, reported) or a
 * negative errno (reported). Blocking. edited: the item whose warnings are reported (check.h);
 * NULL: none.
 */
int edit_commit(const struct rio *rio, const char *file, const char *edited,
                struct config_report *report);
