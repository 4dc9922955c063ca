/* SPDX-License-Identifier: MIT */
/* The native bus over each kind of link master there is: one scheme each. */
#include "hal/ds2482/ds2482.h"
#include "hal/native/native.h"
#include "hal/sim/master.h"

static int create_i2c(const char *where, const struct bus_env *env, struct bus **bus, char *why,
                      size_t why_size)
{
	return native_create(&i2c_bus, &ds2482_i2c_master, where, env, bus, why, why_size);
}

static int create_sim(const char *where, const struct bus_env *env, struct bus **bus, char *why,
                      size_t why_size)
{
	return native_create(&sim_bus, &sim_master, where, env, bus, why, why_size);
}

const struct bus_ops i2c_bus = {
	.scheme = "i2c",
	.summary = "1-Wire devices on DS2482-100, -101, -800, DS2483 or DS2484",
	.create = create_i2c,
	NATIVE_BUS_SLOTS,
};

const struct bus_ops sim_bus = {
	.scheme = "sim",
	.summary = "simulated 1-Wire devices, from a scenario file",
	.create = create_sim,
	NATIVE_BUS_SLOTS,
};
