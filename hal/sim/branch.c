/* SPDX-License-Identifier: MIT */
/* The branches of couplers: the slaves behind them, and what reaches those slaves. */
#include "hal/sim/branch.h"

void sim_branch_put(struct sim_slave *slave, struct sim_slave *coupler,
                    enum sim_branch_number number)
{
	struct sim_branch *branch = &coupler->branches[number];

	slave->behind = branch;
	slave->next_behind = branch->first;
	branch->first = slave;
}

bool sim_branch_connects(const struct sim_slave *slave)
{
	while (slave->plugged && slave->behind && slave->behind->on)
		slave = slave->behind->coupler;
	return slave->plugged && !slave->behind;
}

bool sim_branch_reset(const struct sim_branch *branch, int64_t t)
{
	bool present = false;

	for (struct sim_slave *slave = branch->first; slave; slave = slave->next_behind) {
		if (!slave->plugged)
			continue;
		sim_slave_reset(slave, false, t);
		present = true;
		for (unsigned i = 0; slave->branches && i < SIM_BRANCHES; i++) {
			if (slave->branches[i].on)
				sim_branch_reset(&slave->branches[i], t);
		}
	}
	return present;
}

void sim_branch_restart(const struct sim_branch *branch, int64_t t)
{
	for (struct sim_slave *slave = branch->first; slave; slave = slave->next_behind) {
		if (slave->plugged && slave->parasite)
			sim_slave_brownout(slave, t);
	}
}

bool sim_branch_shorts(const struct sim_slave *coupler)
{
	bool shorts = false;

	for (unsigned i = 0; coupler->branches && i < SIM_BRANCHES; i++)
		shorts |= coupler->branches[i].on && coupler->branches[i].low;
	return shorts;
}
