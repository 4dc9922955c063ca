/* SPDX-License-Identifier: MIT */
/*
 * Slots of simulated slaves that OneWireHub plays reach OneWireHub. The simulator keeps the layer
 * of the ROM commands, so that search and selection are its own; the linker wraps its functions.
 */
#include <string.h>

#include "hal/sim/slave.h"
#include "tests/emulated/hub.h"

#define KNOWN 16

static struct {
	const struct sim_slave *slave;
	struct hub *hub;
} known[KNOWN];
unsigned hub_slots;

void __real_sim_slave_destroy(struct sim_slave *slave);
void __wrap_sim_slave_destroy(struct sim_slave *slave);
void __real_sim_slave_reset(struct sim_slave *slave, bool overdrive, int64_t now_ns);
void __wrap_sim_slave_reset(struct sim_slave *slave, bool overdrive, int64_t now_ns);
bool __real_sim_slave_output(struct sim_slave *slave, int64_t now_ns);
bool __wrap_sim_slave_output(struct sim_slave *slave, int64_t now_ns);
void __real_sim_slave_slot(struct sim_slave *slave, bool line, int64_t now_ns);
void __wrap_sim_slave_slot(struct sim_slave *slave, bool line, int64_t now_ns);

struct hub *hub_of(const struct sim_slave *slave)
{
	unsigned i = 0;

	if (!strstr(slave->family->name, "-EMULATED"))
		return NULL;
	while (i < KNOWN - 1 && known[i].slave && known[i].slave != slave)
		i++;
	if (!known[i].slave) {
		known[i].slave = slave;
		known[i].hub = hub_new(slave->family->name, slave->rom);
	}
	return known[i].hub;
}

void __wrap_sim_slave_destroy(struct sim_slave *slave)
{
	for (unsigned i = 0; i < KNOWN; i++) {
		if (known[i].slave != slave)
			continue;
		hub_free(known[i].hub);
		known[i].slave = NULL;
	}
	__real_sim_slave_destroy(slave);
}

void __wrap_sim_slave_reset(struct sim_slave *slave, bool overdrive, int64_t now_ns)
{
	struct hub *hub = hub_of(slave);
	double in[SIM_MAX_INPUTS] = {0};

	__real_sim_slave_reset(slave, overdrive, now_ns);
	if (!hub || slave->layer == SIM_ROM_IDLE || !slave->plugged)
		return;
	for (unsigned i = 0; slave->family->inputs && slave->family->inputs[i].name; i++)
		in[i] = sim_input_at(slave, i, now_ns);
	hub_set(hub, in);
	hub_reset(hub, now_ns);
}

bool __wrap_sim_slave_output(struct sim_slave *slave, int64_t now_ns)
{
	struct hub *hub = hub_of(slave);

	if (!hub)
		return __real_sim_slave_output(slave, now_ns);
	sim_slave_advance(slave, now_ns);
	return slave->layer == SIM_ROM_IDLE || hub_output(hub, now_ns);
}

void __wrap_sim_slave_slot(struct sim_slave *slave, bool line, int64_t now_ns)
{
	struct hub *hub = hub_of(slave);

	if (!hub) {
		__real_sim_slave_slot(slave, line, now_ns);
		return;
	}
	hub_slots++;
	if (slave->layer != SIM_ROM_IDLE)
		hub_slot(hub, line, now_ns);
}
