/* SPDX-License-Identifier: MIT */
/* Scheme "sim": the native bus over simulated devices. */
#include "hal/sim/bus.h"
#include "hal/native/native.h"
#include "hal/sim/master.h"

static int sim_bus_create(const char *where, const struct bus_env *env, struct bus **bus, char *why,
                          size_t why_size)
{
	return native_create(&sim_bus, &sim_master, where, env, bus, why, why_size);
}

const struct bus_ops sim_bus = {
	.scheme = "sim",
	.summary = "simulated 1-Wire devices, from a scenario file",
	.create = sim_bus_create,
	.caches = "",
	NATIVE_BUS_SLOTS,
};
