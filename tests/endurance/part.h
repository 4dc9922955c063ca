/* SPDX-License-Identifier: MIT */
/* One target of a world: what simulates it below the real backend, and what goes wrong there. */
#pragma once

#include "hal/bus/bus.h"
#include "tests/endurance/field.h"

struct part;

struct part_ops {
	const char *name;
	/* The longest time from a measurement to what the bus calls so. */
	int64_t age_ns;
	/*
	 * Optional. When the kernel gave what was measured at that time or later: no program can
	 * know at what moment of a long call its chip converted, so that the call's begin counts.
	 */
	int64_t (*given)(const struct part *part, int64_t measured_ns);
	/* Once: make what there is; the target's text. */
	void (*begin)(struct part *part, char *target, unsigned size);
	void (*end)(struct part *part);
	/* A bus of the target was made anew; optional. */
	void (*opened)(struct part *part, struct bus *bus);
	/* One thing goes wrong for at most ns; what is said of it. */
	const char *(*fault)(struct part *part, int64_t ns);
	/* The device comes to this wire or leaves it; the switch restarts; its pins are other. */
	void (*plug)(struct part *part, unsigned device, bool in);
	void (*restart)(struct part *part, unsigned device);
	void (*pins)(struct part *part);
	/* The switch's outputs as the chip has them. */
	unsigned (*relays)(struct part *part);
	/* Optional. When it has something to do by itself; do it. */
	int64_t (*next)(struct part *part);
	void (*run)(struct part *part);
	/* When the descriptor that the bus waits on is ready; INT64_MAX: not known yet. */
	int64_t (*ready)(struct part *part, int fd, short events);
};

struct part {
	const struct part_ops *ops;
	unsigned wire;
	char target[160];
	struct bus *bus; /* the one that is open; NULL: none */
	void *own;
};

extern const struct part_ops part_native, part_server, part_sysfs, part_netlink, part_late;

/* station.c: the world's clock; a number below n, by the seed. */
int64_t world_now(void);
uint32_t world_random(uint32_t n);
/* Inside a bus: the kernel keeps its thread so long, and it cannot be waked. */
void world_block(int64_t ns);
/* A fault ends: called once at that time. */
void world_after(int64_t ns, void (*end)(void *ctx), void *ctx);
