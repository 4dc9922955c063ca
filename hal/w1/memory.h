/* SPDX-License-Identifier: MIT */
/* EEPROMs, and the counters of the DS2423. */
#ifndef HAL_W1_MEMORY_H
#define HAL_W1_MEMORY_H

#include "hal/w1/part.h"

extern const struct w1_driver w1_memories[];

#endif
