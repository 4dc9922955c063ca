/* SPDX-License-Identifier: MIT */
/* What the work of a bus has cost: time of its wires, calls of the system. */
#pragma once

#include "hal/native/state.h"

/*
 * What the job's wire did since it was looked at last was a transaction of this job. For what
 * serves several devices (searches, Convert T for all) this function is not called.
 */
void cost_of_job(struct native *native, struct job *job);
/* At the end of a step: the counters have all that was done. */
void cost_take(struct native *native);
