/* SPDX-License-Identifier: MIT */
#include "hal/bus.h"

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
