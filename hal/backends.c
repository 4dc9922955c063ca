/* SPDX-License-Identifier: MIT */
#include "hal/bus.h"

const struct bus_ops *const bus_backends[] = {
	&null_bus,
	&late_bus,
	NULL,
};
