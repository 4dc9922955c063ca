/* SPDX-License-Identifier: MIT */
/* The history that verbs read, by libows-history. */
#pragma once

#include "src/public/ows_history.h"
#include "src/tool/owsctl/ctl.h"

/* Open the history of the instance, or of a directory; CTL_DONE, or CTL_FAILED after saying why. */
int past_open(const struct ctl *ctl, const char *directory, struct ows_history **h);
/*
 * The same for a verb that goes on without: CTL_DONE with *h NULL where no recorder has kept
 * anything for the instance; if that may not be read, after saying so. A directory that is named
 * has to be there.
 */
int past_look(const struct ctl *ctl, const char *directory, struct ows_history **h);
/* A signal by its name, as it is or as INSTANCE__NAME: its index, and *known; -ENOENT. */
int past_signal(struct ows_history *h, const char *instance, const char *name,
                struct ows_history_signal *known);
/*
 * Print that it has no such signal, with the nearest name, or that it has nothing yet of one that
 * owsd has; returns CTL_FAILED.
 */
int past_unknown(const struct ctl *ctl, struct ows_history *h, const char *name);
/* The word for its quality; of a gap its reason. */
const char *past_word(const struct ows_history_item *item);
/* Say why something of it could not be read; returns CTL_FAILED. */
int past_fail(const char *what, int err);
