/* SPDX-License-Identifier: MIT */
/* How a transaction of a job ended, and what follows. */
#pragma once

#include "hal/native/state.h"

/* With err (0: well): what it showed of link and device. */
void job_saw(struct native *native, struct job *job, int err, int64_t now);
/* It failed: again, or answer. */
void job_failed(struct native *native, struct job *job, int err);
/* Its device did not answer: look for it once, on all channels. */
void job_missing(struct native *native, struct job *job, int err);
