/* SPDX-License-Identifier: MIT */
/*
 * The branches of couplers: the slaves behind a branch are on the wire only while it is on, and so
 * are those behind the couplers on it.
 */
#pragma once

#include "hal/sim/slave.h"

enum sim_branch_number { SIM_MAIN, SIM_AUX, SIM_BRANCHES };

/* A coupler has SIM_BRANCHES of them in its state; sim_slave.branches is the first. */
struct sim_branch {
	struct sim_slave *coupler;
	struct sim_slave *first; /* behind it; sim_slave.next_behind is the next */
	bool on;                 /* part of the coupler's own wire */
	bool low;                /* short to ground */
	bool event;              /* went low while it was off */
};

/* Put a slave of the same wire behind a branch of the coupler. Before the first access. */
void sim_branch_put(struct sim_slave *slave, struct sim_slave *coupler,
                    enum sim_branch_number number);
/* Does the slave hear the master: is it plugged, and each branch on the way to it on? */
bool sim_branch_connects(const struct sim_slave *slave);
/* Reset what would be on the wire if the branch were on; true: a slave answers. */
bool sim_branch_reset(const struct sim_branch *branch, int64_t t);
/* The branch was without supply: the slaves behind it that the wire feeds restart. */
void sim_branch_restart(const struct sim_branch *branch, int64_t t);
/* Is one of the coupler's branches on and short? */
bool sim_branch_shorts(const struct sim_slave *coupler);
