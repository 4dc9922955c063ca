/* SPDX-License-Identifier: MIT */
/* What a conversion of all DS2450 at once needs of the chip (data sheet 19-5125). */
#ifndef HAL_CHIPS_DS2450_H
#define HAL_CHIPS_DS2450_H

#include "hal/chips/area.h"

/* All four channels with 16 bits. */
extern const struct conversion ds2450_conversion;

#endif
