/* SPDX-License-Identifier: MIT */
/*
 * Thermometers on different chips of a master are read, and start in turn, at the same time
 * (link_ops.run_many): the transactions of a group are made first; then each job takes its step,
 * and finds its transaction done. What has gone wrong is not judged here: the job makes its
 * transaction again by itself, in a later step, with all that follows an error.
 *
 * Only what may be done twice is done so: to read a scratchpad, and to convert. A chip whose start
 * failed counts as one that may have heard it.
 */
#pragma once

#include "hal/native/state.h"

/*
 * Read this job's thermometer, or start it in turn; and read or start one of each other chip, where
 * a result is ready or a start is due.
 */
void together_step(struct native *native, struct job *job, int64_t now);
