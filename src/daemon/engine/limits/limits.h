/* SPDX-License-Identifier: MIT */
/* The limit alarms of the signals. */
#pragma once

#include "src/daemon/engine/state.h"

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
/* Take up what the image's shelves have from before a start or a reload. */
void engine_shelves_resume(struct engine *e);
