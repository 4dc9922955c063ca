/* SPDX-License-Identifier: MIT */
/*
 * Sensors of CMC Industrial Electronics. No data sheet could be had: the command is that of OWFS's
 * driver.
 */
#include "hal/chips/makers/cmciel.h"

AREA_NAMED(cmciel_reading, "reading", .size = 3, .block = 3, .read = 0xbe, .check = AREA_CRC8);
