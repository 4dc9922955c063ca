/* SPDX-License-Identifier: MIT */
/* Writes to /simultaneous. */
#ifndef HAL_NATIVE_SIMULTANEOUS_H
#define HAL_NATIVE_SIMULTANEOUS_H

#include "hal/native/state.h"

void convert_all(struct native *native, struct job *job);

#endif
