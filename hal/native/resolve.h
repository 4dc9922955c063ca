/* SPDX-License-Identifier: MIT */
/* What the path of a request means. */
#pragma once

#include "hal/native/state.h"

/* Fills the job from its path. 0 or the error to answer. */
int resolve(struct native *native, struct job *job);
