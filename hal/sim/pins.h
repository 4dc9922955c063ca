/* SPDX-License-Identifier: MIT */
/*
 * The open-drain pins of the switch families: each has an output latch, and a curve drives it from
 * outside. The state of such a slave begins with a struct sim_pins.
 */
#pragma once

#include "hal/sim/slave.h"

struct sim_pins {
	uint8_t latch;         /* 1: the output transistor is off */
	uint8_t level;         /* the level of each pin */
	uint8_t activity;      /* the pin changed since the host cleared the flag */
	unsigned first, count; /* the pins' inputs among those of the family */
	int64_t seen;          /* the inputs were followed up to this time */
};

/* Power on: all transistors off, no activity. */
void sim_pins_start(struct sim_slave *slave, unsigned first, unsigned count);
/* Follow the inputs up to now; for struct sim_family. */
void sim_pins_follow(struct sim_slave *slave);
/* Set the latches. The pins were followed up to now. */
void sim_pins_write(struct sim_slave *slave, uint8_t latch);

/* PIO access of two pins, or Channel Access of eight: for struct sim_function. */
#define SIM_PINS_READ(number) .code = (number), .start = sim_pins_send, .next = sim_pins_send
#define SIM_PINS_WRITE(number) \
	.code = (number), .takes = 2, .start = sim_pins_take, .next = sim_pins_taken
void sim_pins_send(struct sim_slave *slave);
void sim_pins_take(struct sim_slave *slave);
void sim_pins_taken(struct sim_slave *slave);
