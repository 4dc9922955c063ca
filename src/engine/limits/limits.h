/* SPDX-License-Identifier: MIT */
/* The limit alarms of the signals. */
#pragma once

#include "src/engine/state.h"

/*
 * Bring the limit alarms of the signal to the present. Returns when they change next by time alone;
 * INT64_MAX: never.
 */
int64_t engine_limits(struct engine *e, struct signal *s);
/* The signal has no limits any more: what the journal has of those of before ends. */
void engine_limits_end(struct engine *e, const struct signal *s, const struct signal *before);
void engine_limits_acknowledge(struct engine *e, struct signal *s, const struct ows_who *who);
/*
 * Shelve the limit alarm of the signal for so many seconds; 0: unshelve it, which does nothing to
 * one that is not shelved. why: as many of OWS_TEXT bytes as come before a NUL. The caller
 * publishes the signal. 0; -EOPNOTSUPP: it has no limit alarms; -ERANGE: more than OWS_SHELVE_MAX;
 * -ENOSPC: OWS_SHELVES others are shelved; -EAGAIN: too many requests, later again.
 */
int engine_shelve(struct engine *e, struct signal *s, uint32_t seconds, const struct ows_who *who,
                  const char *why);

/*
 * The places of shelved limit alarms: the image's area of shelves, where each entry is one signal.
 * owsd alone writes the image, so the entries there are what the engine knows of them.
 */

/* What stands in the image of the signal's shelved alarm; NULL: it is not shelved. */
const struct ows_shelf_entry *engine_shelf(const struct engine *e, const struct signal *s);
/* Enter the signal, or enter it anew. 0, -ENOSPC: OWS_SHELVES others are shelved. */
int engine_shelf_put(struct engine *e, struct signal *s, const struct ows_shelf_entry *entry);
void engine_shelf_free(struct engine *e, struct signal *s);
/* Take up what the image has from before a start or a reload. */
void engine_shelves_resume(struct engine *e);
