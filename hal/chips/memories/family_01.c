/* SPDX-License-Identifier: MIT */
/*
 * DS2401, DS1990A, and DS1420, which is that of an iButton for USB (data sheet 19-4890): an id and
 * nothing else.
 */
#include "hal/chips/family.h"

CHIP_FAMILY(01, "DS2401", NONE_READ, SCAN({"present", "present"}));
CHIP_FAMILY(81, "DS1420", NONE_READ, .flags = 0);
