/* SPDX-License-Identifier: MIT */
/*
 * The sensors of Embedded Data Systems: a kind is a table of what it measures and where its
 * registers are.
 */
#pragma once

#include "hal/base/time.h"
#include "hal/sim/chips/scratchpad.h"

/* What a kind measures: a register, its limits, and a pair of alarm flags (high, low). */
struct eds_quantity {
	const char *input; /* its value, unless derived */
	double (*derived)(struct sim_slave *slave);
	double unit; /* of the register */
	uint8_t at, bytes;
	uint8_t high, low, limit_bytes; /* limit_bytes 0: no limits */
	uint8_t flag;                   /* of the pair, the first */
	uint8_t min, max;               /* since the alarms were cleared; 0: none */
	bool coarse;                    /* limits are whole units */
};

struct eds_kind {
	struct sim_scratchpad_kind memory; /* first */
	const struct eds_quantity *quantities;
	const char *tag;
	uint16_t id;       /* 0x0064: EDS0064 */
	uint16_t measures; /* a bit for each quantity that the kind has */
	uint8_t quantity_count;
	uint8_t writable;               /* from here on */
	uint8_t alarm, alarm_bytes;     /* flags; the enables have as many bytes */
	uint8_t enable, seconds, relay; /* relay: its function, then its state */
	uint8_t peak, samples, delay;   /* 0: none */
	bool digital;
};

/* For struct sim_family. */
struct eds {
	struct sim_scratchpad memory; /* first */
	int64_t started, sampled, followed, tick;
	double least[16], most[16], peak;
	uint8_t level; /* of eight pins */
};
extern const struct sim_function eds_functions[];
/* OWFS: 700 ms after a copy the new bytes can be read. */
#define EDS_COPY_NS (600 * NS_PER_MS)
void eds_create(struct sim_slave *slave);
void eds_power_on(struct sim_slave *slave);
void eds_worked(struct sim_slave *slave);
void eds_advance(struct sim_slave *slave);
bool eds_alarm(struct sim_slave *slave);
