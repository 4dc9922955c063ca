/* SPDX-License-Identifier: MIT */
/* A simulated wire: the slots of one master on all slaves. */
#include <errno.h>
#include <stdlib.h>

#include "hal/sim/branch.h"
#include "hal/sim/wire.h"

int sim_wire_add(struct sim_wire *wire, struct sim_slave *slave)
{
	size_t count = wire->count + 1;
	struct sim_slave **slaves = realloc(wire->slaves, count * sizeof(struct sim_slave *));

	if (!slaves)
		return -ENOMEM;
	wire->slaves = slaves;
	slaves = realloc(wire->active, count * sizeof(struct sim_slave *));
	if (!slaves)
		return -ENOMEM;
	wire->active = slaves;
	wire->slaves[wire->count++] = slave;
	wire->coupled |= slave->branches != NULL;
	return 0;
}

void sim_wire_clear(struct sim_wire *wire)
{
	for (size_t i = 0; i < wire->count; i++)
		sim_slave_destroy(wire->slaves[i]);
	free(wire->slaves);
	free(wire->active);
	*wire = (struct sim_wire){0};
}

/* No slot reaches a slave; a branch that is on shorts the wire with itself. */
static bool is_dead_wire(const struct sim_wire *wire, int64_t t)
{
	bool shorted = wire->shorted;

	for (size_t i = 0; wire->coupled && i < wire->count; i++) {
		struct sim_slave *slave = wire->slaves[i];

		if (!slave->branches)
			continue;
		sim_slave_advance(slave, t);
		shorted |= sim_branch_connects(slave) && sim_branch_shorts(slave);
	}
	return shorted || wire->unpowered;
}

bool sim_wire_reset(struct sim_wire *wire, bool overdrive, int64_t t)
{
	wire->resets++;
	wire->active_count = 0;
	if (is_dead_wire(wire, t))
		return false;
	for (size_t i = 0; i < wire->count; i++) {
		struct sim_slave *slave = wire->slaves[i];

		if (!sim_branch_connects(slave))
			continue;
		sim_slave_reset(slave, overdrive, t);
		if (slave->layer != SIM_ROM_IDLE)
			wire->active[wire->active_count++] = slave;
	}
	return wire->active_count > 0;
}

/* A coupler may have switched: those that hear the next slot. */
static void regroup_active(struct sim_wire *wire)
{
	wire->active_count = 0;
	for (size_t i = 0; i < wire->count; i++) {
		struct sim_slave *slave = wire->slaves[i];

		if (slave->layer != SIM_ROM_IDLE && sim_branch_connects(slave))
			wire->active[wire->active_count++] = slave;
	}
}

bool sim_wire_slot(struct sim_wire *wire, bool out, bool overdrive, int64_t t)
{
	bool line = out, coupler = false;
	size_t kept = 0;

	wire->slots++;
	if (is_dead_wire(wire, t)) {
		wire->active_count = 0;
		return false;
	}
	for (size_t i = 0; i < wire->active_count; i++) {
		struct sim_slave *slave = wire->active[i];

		if (!slave->plugged || slave->overdrive != overdrive)
			sim_end(slave);
		line &= sim_slave_output(slave, t);
	}
	for (size_t i = 0; i < wire->active_count; i++) {
		struct sim_slave *slave = wire->active[i];

		sim_slave_slot(slave, line, t);
		coupler |= slave->branches != NULL;
		if (slave->layer != SIM_ROM_IDLE)
			wire->active[kept++] = slave;
	}
	wire->active_count = kept;
	if (coupler)
		regroup_active(wire);
	return line;
}

bool sim_wire_level(const struct sim_wire *wire, int64_t t)
{
	return !is_dead_wire(wire, t);
}

void sim_wire_strong(struct sim_wire *wire, bool on, int64_t t)
{
	if (wire->strong == on)
		return;
	wire->strong = on;
	for (size_t i = 0; i < wire->count; i++) {
		if (wire->slaves[i]->plugged)
			sim_slave_strong(wire->slaves[i],
			                 on && !is_dead_wire(wire, t) &&
			                         sim_branch_connects(wire->slaves[i]),
			                 t);
	}
}

void sim_wire_power(struct sim_wire *wire, bool on, int64_t t)
{
	if (wire->unpowered == !on)
		return;
	wire->unpowered = !on;
	for (size_t i = 0; on && i < wire->count; i++) {
		if (sim_branch_connects(wire->slaves[i]) && wire->slaves[i]->parasite)
			sim_slave_brownout(wire->slaves[i], t);
	}
}

void sim_wire_plug(struct sim_wire *wire, struct sim_slave *slave, bool in, int64_t t)
{
	if (slave->plugged == in)
		return;
	slave->plugged = in;
	if (!in) {
		sim_slave_advance(slave, t);
		return;
	}
	slave->strong = wire->strong && sim_branch_connects(slave);
	sim_slave_power_on(slave, t);
	if (slave->behind && !slave->behind->on)
		slave->behind->event = true; /* its presence pulse */
}
