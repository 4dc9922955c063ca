/* SPDX-License-Identifier: MIT */
/* What a conversion of all DS2450 at once needs of the chip (data sheet 19-5125). */
#ifndef HAL_CHIPS_DS2450_H
#define HAL_CHIPS_DS2450_H

#include "hal/wire/txn.h"

#define DS2450_CONVERT 0x3c
/* Four channels of 16 bits at 80 us, and 160 us. */
#define DS2450_CONVERT_NS (6 * TXN_MS)

#endif
