/* SPDX-License-Identifier: MIT */
/*
 * A simulated 1-Wire wire: the slots of one master reach the slaves on it, and the line is the AND
 * of all. Deaf slaves are skipped until the next reset, so that a hundred of them cost little.
 */
#pragma once

#include "hal/sim/slave.h"

struct sim_wire {
	struct sim_slave **slaves, **active; /* both have room for all slaves */
	size_t count, active_count;
	bool coupled;           /* there are couplers: slaves may be behind a branch (branch.h) */
	bool shorted;           /* a short to ground */
	bool unpowered;         /* the port is switched off (DS2483, DS2484) */
	bool strong;            /* the strong pull-up is on */
	uint64_t resets, slots; /* totals, for the tests */
};

/* 0, or -ENOMEM. The wire owns the slave from then on. */
int sim_wire_add(struct sim_wire *wire, struct sim_slave *slave);
void sim_wire_clear(struct sim_wire *wire);

/* A reset pulse; true: a slave answers with its presence pulse. On a shorted line none does. */
bool sim_wire_reset(struct sim_wire *wire, bool overdrive, int64_t t);
/* One time slot in which the master writes out; returns the level as sampled. */
bool sim_wire_slot(struct sim_wire *wire, bool out, bool overdrive, int64_t t);
/* The level of the idle line. */
bool sim_wire_level(const struct sim_wire *wire, int64_t t);
void sim_wire_strong(struct sim_wire *wire, bool on, int64_t t);
/* Switch the port's supply: slaves fed by the wire restart when it comes back. */
void sim_wire_power(struct sim_wire *wire, bool on, int64_t t);
/* A slave comes to the wire (and powers on) or leaves it. */
void sim_wire_plug(struct sim_wire *wire, struct sim_slave *slave, bool in, int64_t t);
