/* SPDX-License-Identifier: MIT */
/* The table of all backends of this build. */
#include "hal/bus/bus.h"

const struct bus_ops *const bus_backends[] = {
#define BACKEND(name) &name##_bus,
#include "hal/bus/schemes.h"
#undef BACKEND
	NULL,
};
