/* SPDX-License-Identifier: MIT */
/* A property is read or written, or a chip says what it is before its properties are listed. */
#pragma once

#include "hal/native/state.h"

/* Takes what is written for the present element into the transaction. 0 or -EINVAL. */
int job_take_value(struct job *job);
/* One transaction of it, or the answer. */
void job_run_property(struct native *native, struct job *job, int64_t now);
/*
 * A list of a device's properties, or its type: does the device have to say first which chip of its
 * family it is?
 */
bool job_asks_first(const struct job *job, int64_t now);
/* Then: one transaction of that, or the answer. */
void job_run_asking(struct native *native, struct job *job, int64_t now);
