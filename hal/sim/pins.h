/* SPDX-License-Identifier: MIT */
/* Open-drain pins of the switch families: an output latch each, and what drives it from outside. */
#ifndef HAL_SIM_PINS_H
#define HAL_SIM_PINS_H

#include "hal/sim/slave.h"

struct sim_pins {
	uint8_t latch;    /* 1: the output transistor is off */
	uint8_t level;    /* as it is on the pins */
	uint8_t activity; /* changed since it was cleared */
	unsigned count;   /* of pins; their inputs are the family's first ones */
	int64_t seen;     /* up to when they were followed */
};

/* Power-on: all transistors off, nothing happened. */
void sim_pins_start(struct sim_slave *slave, struct sim_pins *pins, unsigned count, int64_t t);
/* Follow the inputs up to t. */
void sim_pins_follow(struct sim_slave *slave, struct sim_pins *pins, int64_t t);
/* Set the latches at t, up to which the pins were followed. */
void sim_pins_write(struct sim_slave *slave, struct sim_pins *pins, uint8_t latch, int64_t t);

#endif
