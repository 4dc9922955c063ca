/* SPDX-License-Identifier: MIT */
/* The table of all backends. Alone in this file, so that a program can be linked with another. */
#include "hal/bus/bus.h"

const struct bus_ops *const bus_backends[] = {
#define BACKEND(name) &name##_bus,
#include "hal/bus/schemes.h"
#undef BACKEND
	NULL,
};
