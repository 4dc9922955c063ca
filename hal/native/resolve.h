/* SPDX-License-Identifier: MIT */
/* What the path of a request means. */
#ifndef HAL_NATIVE_RESOLVE_H
#define HAL_NATIVE_RESOLVE_H

#include "hal/native/state.h"

/* Fills the job from its path. 0 or the error to answer. */
int resolve(struct native *native, struct job *job);

#endif
