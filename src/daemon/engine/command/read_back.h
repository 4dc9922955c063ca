/* SPDX-License-Identifier: MIT */
/* Does an output still have what was written? (docs/semantics.md, section 3, "Read back") */
#pragma once

#include "src/daemon/engine/state.h"

/*
 * An output was read, and the sample has the value; *quality becomes OWS_Q_DIFFERS if that is not
 * what was written. False: it differs for the first time, or is older than the last write, and the
 * next reading decides.
 */
bool engine_compare(struct engine *e, struct lane *lane, struct signal *s, const struct slot *slot,
                    uint8_t *quality);
/* The signal differed, and will not be compared any more: that ends in the journal too. */
void engine_compares_no_more(struct engine *e, struct signal *s, uint8_t quality);

/* Whether its device restarted, asked of a power-on flag. */
/* True: the request for such a flag was given to the bus. */
bool engine_restart_ask(struct lane *lane, struct slot *slot);
void engine_restart_done(struct lane *lane, const struct slot *slot,
                         const struct bus_answer *answer);
