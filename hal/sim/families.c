/* SPDX-License-Identifier: MIT */
/* The table of the families. */
#include <stddef.h>

#include "hal/sim/families.h"

#define ENTRY(part) &sim_##part,

const struct sim_family *const sim_families[] = {SIM_FAMILIES(ENTRY) NULL};
