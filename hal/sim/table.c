/* SPDX-License-Identifier: MIT */
/* The table of the backends and sim: owsd-sim is linked with it in place of hal/bus/table.c. */
#include "hal/bus/bus.h"
#include "hal/sim/bus.h"

const struct bus_ops *const bus_backends[] = {
#define BACKEND(name, automatic) &name##_bus,
#include "hal/bus/schemes.h"
#undef BACKEND
	&sim_bus,
	NULL,
};
