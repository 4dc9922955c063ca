/* SPDX-License-Identifier: MIT */
/* The DS2438. */
#ifndef HAL_W1_DS2438_H
#define HAL_W1_DS2438_H

#include "hal/w1/part.h"

extern const struct w1_driver w1_ds2438[];

#endif
