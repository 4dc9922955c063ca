/* SPDX-License-Identifier: MIT */
/*
 * The simulated network as an I2C adapter. A transaction takes the time that the bus's speed gives
 * it, and waits for that time through the environment (which on a virtual clock moves it).
 */
#pragma once

#include "hal/bus/bus.h"
#include "hal/ds2482/i2c.h"
#include "hal/sim/net.h"

struct sim_adapter {
	struct i2c_adapter adapter;
	struct sim_net *net; /* the caller owns it */
	const struct bus_env *env;
	int64_t free_at; /* when the last transaction ends */
	bool open;
};

/* Limits and speed are those of the network. Allocates nothing. */
void sim_adapter_init(struct sim_adapter *adapter, struct sim_net *net, const struct bus_env *env);
