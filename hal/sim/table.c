/* SPDX-License-Identifier: MIT */
/* The backends, sim and replay: owsd-sim has this table in place of hal/bus/table.c. */
#include "hal/bus/bus.h"
#include "hal/sim/bus.h"
#include "hal/sim/replay.h"

const struct bus_ops *const bus_backends[] = {
#define BACKEND(name, automatic) &name##_bus,
#include "hal/bus/schemes.h"
#undef BACKEND
	&sim_bus,
	&replay_bus,
	NULL,
};
