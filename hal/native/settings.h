/* SPDX-License-Identifier: MIT */
/* /settings: what can be changed while the bus runs. */
#ifndef HAL_NATIVE_SETTINGS_H
#define HAL_NATIVE_SETTINGS_H

#include "hal/native/state.h"

/* As they are at the start. */
void native_settings(struct native *native);

extern const struct family virtual_settings;

#endif
