/* SPDX-License-Identifier: MIT */
/*
 * A link master for tests: slots reach the simulated slaves directly, without a bridge chip, and
 * each takes its time on the host's clock. Faults are injected at the link's calls.
 */
#pragma once

#include "hal/sim/wire.h"
#include "hal/wire/link.h"
#include "tests/unit/aid/host.h"
#include "tests/unit/aid/trouble.h"

#define WIRE_CHANNELS 8

struct wire_net {
	struct host *host;
	unsigned channels; /* fewer than at the start: the chips of the others are gone */
	unsigned chips;    /* 1: all channels share one */
	struct sim_wire wire[WIRE_CHANNELS];
	struct link_cost cost; /* of the first link, but the resets */
	uint64_t resets[WIRE_CHANNELS];
	struct link_master_cost shared; /* of all links together */
	/*
	 * The next `fault_count` calls return `fault`; a recovery of fault_until or above ends it.
	 */
	int fault;
	unsigned fault_count;
	int fault_until;
	unsigned recovered[LINK_RUNGS];
	int rung_err[LINK_RUNGS]; /* what recover() returns */
	bool passive;             /* the links have no strong pull-up */
	int open_error;
	unsigned opens, closes;
	int64_t converts[64]; /* when a broadcast Convert T went out */
	unsigned convert_count;
	unsigned strong_count;
	int64_t strong_ns; /* how long the last strong pull-up was on */
	int64_t strong_begin;
	void (*sent)(const uint8_t *data, size_t n);  /* NULL, or called at each write */
	void (*sends)(const uint8_t *data, size_t n); /* the same, ahead of its slots */
	struct trouble *trouble;   /* NULL: none; restarts are those of the first wire's chips */
	void (*used)(int64_t now); /* NULL, or called before each reset and slot */
};

/* One network at a time. */
extern struct wire_net wire_net;
extern const struct bus_ops wire_bus;

void wire_init(struct host *host, unsigned channels, unsigned chips);
void wire_clear(void);
/* Add a slave of the named chip, powered on; its id is made of the number. */
struct sim_slave *wire_add(unsigned channel, const char *chip, unsigned id);
void wire_set(struct sim_slave *slave, const char *input, double value);
/* Open the bus; the test steps it. */
struct bus *wire_open(void);
/* The simulation's time. */
int64_t wire_time(void);
