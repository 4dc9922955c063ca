/* SPDX-License-Identifier: MIT */
/* /settings: what can be changed while the bus runs. */
#pragma once

#include "hal/native/state.h"

/* As they are at the start. */
void native_settings(struct native *native);

extern const struct family virtual_settings;
