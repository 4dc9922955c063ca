/* SPDX-License-Identifier: MIT */
/* Does an output still have what was written? (docs/semantics.md, section 3, "Read back") */
#pragma once

#include "hal/bus/bus.h"

struct engine;
struct lane;
struct signal;
struct slot;

/*
 * An output was read, and the sample has the value; *quality becomes OWS_Q_DIFFERS if that is not
 * what was written. False: it differs for the first time, or is older than the last write, and the
 * next reading decides.
 */
bool engine_compare(struct engine *e, struct lane *lane, struct signal *s, const struct slot *slot,
                    uint8_t *quality);
/* The signal differed, and will not be compared any more: that ends in the journal too. */
void engine_compares_no_more(struct engine *e, struct signal *s, uint8_t quality);
