/* SPDX-License-Identifier: MIT */
/* The table of the backends. Alone in this file: owsd-sim is linked with that of hal/sim. */
#include "hal/bus/bus.h"

const struct bus_ops *const bus_backends[] = {
#define BACKEND(name, automatic) &name##_bus,
#include "hal/bus/schemes.h"
#undef BACKEND
	NULL,
};
