/* SPDX-License-Identifier: MIT */
/* What a signal keeps over a reload. */
#pragma once

#include "src/daemon/engine/table.h"

/*
 * The signal s, new of the changed configuration, goes on where `was` of the old one stands. What
 * the file says counts where it was changed.
 */
bool signal_adopt(struct signal *s, const struct signal *was);
