/* SPDX-License-Identifier: MIT */
/* One request on its way. */
#pragma once

#include "hal/native/state.h"

/* What the path means, and the answer, if it needs no wire. */
void job_look(struct native *native, struct job *job, int64_t now);
/* May it do its next transaction now? If not, *next is lowered to when it may. */
bool job_ready(const struct native *native, const struct job *job, int64_t now, int64_t *next);
/* Is a's turn before b's? b NULL: there is none. */
bool job_goes_first(const struct native *native, const struct job *a, const struct job *b);
/* One transaction or less. */
void job_step(struct native *native, struct job *job, int64_t now);
