/* SPDX-License-Identifier: MIT */
/*
 * DS2401 (data sheet 19-5860), and DS1420 (19-4890), the id of iButtons for USB: a ROM id and
 * nothing else.
 */
#include "hal/sim/families.h"

const struct sim_family sim_ds2401 = {.name = "DS2401", .code = 0x01};
const struct sim_family sim_ds1420 = {.name = "DS1420", .code = 0x81};
