/* SPDX-License-Identifier: MIT */
/* DS2401 (data sheet 19-5860): a ROM id and nothing else. */
#include "hal/sim/families.h"

const struct sim_family sim_ds2401 = {.name = "DS2401", .code = 0x01};
