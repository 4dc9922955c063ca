/* SPDX-License-Identifier: MIT */
/* OWFS's example of a slave: an id; what it is read for comes from OWFS itself. */
#include "hal/sim/families.h"

const struct sim_family sim_example_slave = {.name = "Example_slave", .code = 0xDD};
