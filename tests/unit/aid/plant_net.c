/* SPDX-License-Identifier: MIT */
/*
 * Finds the simulation below a bus. A file of its own, because engine and native bus both have a
 * `device`.
 */
#include "hal/native/native.h"
#include "hal/native/state.h"
#include "hal/sim/master.h"
#include "tests/unit/aid/plant.h"

struct sim_net *plant_net(struct bus *bus)
{
	return sim_master_net(((struct native *)bus)->master);
}
