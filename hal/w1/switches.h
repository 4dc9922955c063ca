/* SPDX-License-Identifier: MIT */
/* DS2405, DS2406, DS2408 and DS2413. */
#ifndef HAL_W1_SWITCHES_H
#define HAL_W1_SWITCHES_H

#include "hal/w1/part.h"

extern const struct w1_driver w1_switches[];

#endif
