/* SPDX-License-Identifier: MIT */
/* The table of all backends of this build. */
#include "hal/bus/bus.h"

/* clang-format off */
const struct bus_ops *const bus_backends[] = {
	&owserver_bus,
	&i2c_bus,
	&w1_bus,
	&gpio_bus,
	&sim_bus,
	&null_bus,
	&late_bus,
	NULL,
};
/* clang-format on */
