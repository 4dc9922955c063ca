/* SPDX-License-Identifier: MIT */
/*
 * The places of shelved limit alarms: the image's area of shelves, where each entry is one signal.
 * owsd alone writes the image, so the entries there are what the engine knows of them.
 */
#ifndef ENGINE_SHELF_H
#define ENGINE_SHELF_H

#include "src/engine/state.h"

/* What stands in the image of the signal's shelved alarm; NULL: it is not shelved. */
const struct ows_shelf_entry *engine_shelf(const struct engine *e, const struct signal *s);
/* Enter the signal, or enter it anew. 0, -ENOSPC: OWS_SHELVES others are shelved. */
int engine_shelf_put(struct engine *e, struct signal *s, const struct ows_shelf_entry *entry);
void engine_shelf_free(struct engine *e, struct signal *s);
/* Take up what the image has from before a start or a reload. */
void engine_shelves_resume(struct engine *e);

#endif
