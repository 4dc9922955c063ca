/* SPDX-License-Identifier: MIT */
/* The master: open, lost, opened again; the recovery ladder. */
#pragma once

#include "hal/native/state.h"

int64_t master_step(struct native *native, int64_t now); /* opens; when to try again */
void master_down(struct native *native, int err, const char *why);
/* After a link's error: one rung. False: the target is down now. */
bool master_recover(struct native *native, unsigned channel, int err);
void master_good(struct native *native, unsigned channel);
/* Now and then: take chips that were missing. *next as elsewhere. */
void master_grow(struct native *native, int64_t now, int64_t *next);
