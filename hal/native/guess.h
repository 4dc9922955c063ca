/* SPDX-License-Identifier: MIT */
/*
 * On which of several wires are the thermometers that are asked for after a start?
 *
 * A search that stops where only one of the ids that are asked for, or known, begins as the bits
 * read so far takes a third of a whole one. It does not show whether that device is there: owsd
 * reads it on that wire for the request, and the answer proves it (first.h). The search for all
 * comes after, and finds what was hidden behind such a beginning.
 */
#pragma once

#include "hal/native/state.h"

/* One pass of it on one wire, some 8 ms. Returns false when there is nothing to do. */
bool guess_step(struct native *native, int64_t now);
