/* SPDX-License-Identifier: MIT */
/* A property is read or written. */
#ifndef HAL_NATIVE_EXCHANGE_H
#define HAL_NATIVE_EXCHANGE_H

#include "hal/native/state.h"

/* One transaction of it, or the answer. */
void job_run_property(struct native *native, struct job *job, int64_t now);

#endif
