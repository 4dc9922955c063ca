/* SPDX-License-Identifier: MIT */
/*
 * Open-drain pins of the switch families: an output latch each, and what drives it from outside.
 * The state of such a slave begins with a struct sim_pins.
 */
#ifndef HAL_SIM_PINS_H
#define HAL_SIM_PINS_H

#include "hal/sim/slave.h"

struct sim_pins {
	uint8_t latch;         /* 1: the output transistor is off */
	uint8_t level;         /* as it is on the pins */
	uint8_t activity;      /* changed since it was cleared */
	unsigned first, count; /* their inputs among the family's */
	int64_t seen;          /* up to when they were followed */
};

/* Power-on: all transistors off, nothing happened. */
void sim_pins_start(struct sim_slave *slave, unsigned first, unsigned count, int64_t t);
/* Follow the inputs up to t; for struct sim_family. */
void sim_pins_follow(struct sim_slave *slave, int64_t t);
/* Set the latches at t, up to which the pins were followed. */
void sim_pins_write(struct sim_slave *slave, uint8_t latch, int64_t t);

/* PIO access of two pins, or Channel Access of eight: for struct sim_function. */
#define SIM_PINS_READ(number) \
	{ \
		.code = (number), .start = sim_pins_send, .next = sim_pins_send \
	}
#define SIM_PINS_WRITE(number) \
	{ \
		.code = (number), .takes = 2, .start = sim_pins_take, .next = sim_pins_taken \
	}
void sim_pins_send(struct sim_slave *slave, int64_t t);
void sim_pins_take(struct sim_slave *slave, int64_t t);
void sim_pins_taken(struct sim_slave *slave, int64_t t);

#endif
