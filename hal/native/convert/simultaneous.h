/* SPDX-License-Identifier: MIT */
/* Writes to /simultaneous. */
#pragma once

#include "hal/native/state.h"

void convert_all(struct native *native, struct job *job);
