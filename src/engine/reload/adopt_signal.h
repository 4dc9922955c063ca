/* SPDX-License-Identifier: MIT */
/* What a signal keeps over a reload. */
#ifndef ENGINE_ADOPT_SIGNAL_H
#define ENGINE_ADOPT_SIGNAL_H

#include "src/engine/table.h"

/*
 * The signal s, new of the changed configuration, goes on where `was` of the old one stands. What
 * the file says counts where it was changed.
 */
bool signal_adopt(struct signal *s, const struct signal *was);

#endif
