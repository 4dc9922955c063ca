/* SPDX-License-Identifier: MIT */
/*
 * A reload: an engine of the changed configuration takes over from the one that runs. The taking
 * over neither allocates nor searches, and belongs to the engine's thread.
 */
#pragma once

#include <stdint.h>

#include "src/daemon/engine/reload/adoption.h"
#include "src/daemon/engine/table.h"

struct engine;

/*
 * The signal s, new of the changed configuration, goes on where `was` of the old one stands. What
 * the file says counts where it was changed.
 */
bool signal_adopt(struct signal *s, const struct signal *was);

/*
 * e is as engine_create() made it, its image not shown and its commands empty; old has run until
 * now. The signals that stay go on with value, quality, alarms and retries, as do the targets that
 * stay with what they were lent: their answers are e's from here on. The commands of old are
 * retired and carried over. old serves no more; it may be destroyed when the buses that did not
 * stay have ended.
 */
void engine_adopt(struct engine *e, struct engine *old, const struct adoption *plan,
                  int64_t now_ns);
/* The buses that did not stay have ended: guests get back what they had lent to those. */
void engine_abandon(struct engine *old);
