/* SPDX-License-Identifier: MIT */
/*
 * The open-drain pins of the switch families: each has an output latch, and a curve drives it from
 * outside. The state of such a slave begins with a struct sim_pins. DS2408 and DS28E04 have
 * registers of their pins in addition, which say when the chip answers a conditional search.
 */
#pragma once

#include "hal/sim/slave.h"

struct sim_pins {
	uint8_t latch;      /* 1: the output transistor is off */
	uint8_t level;      /* the level of each pin */
	uint8_t activity;   /* the pin changed since the host cleared the flag */
	uint16_t registers; /* the address of the first one; 0: the chip has none */
	uint8_t mask, polarity, control;
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

/* The registers; the last three bits of the first one's address are 0. */
enum { SIM_LOGIC, SIM_LATCH, SIM_ACTIVITY, SIM_MASK, SIM_POLARITY, SIM_CONTROL, SIM_PIN_REGISTERS };
/* Control/status register. */
enum {
	SIM_PLS = 0x01, /* the source of a search is activity, not level */
	SIM_CT = 0x02,  /* all pins of the mask have to match, not one */
	SIM_ROS = 0x04,
	SIM_PORL = 0x08, /* since power-on; it can be cleared, not set */
	SIM_POL = 0x40,
	SIM_VCCP = 0x80,
};
/* The registers as a host reads them. */
void sim_pins_registers(const struct sim_slave *slave, uint8_t out[SIM_PIN_REGISTERS]);
/* Does the condition hold of mask, polarity and control? */
bool sim_pins_match(struct sim_slave *slave);
/* Channel Access Read, Write Conditional Search Register, Reset Activity Latches. */
#define SIM_PINS_REGISTER_FUNCTIONS \
	{.code = 0xF5, .start = sim_pins_sample, .next = sim_pins_sample}, \
		{.code = 0xCC, \
	         .takes = 2, \
	         .start = sim_pins_check_condition, \
	         .byte = sim_pins_write_condition}, \
	{ \
		.code = 0xC3, .start = sim_pins_reset_activity, .next = sim_pins_confirm \
	}
void sim_pins_sample(struct sim_slave *slave);
void sim_pins_check_condition(struct sim_slave *slave);
void sim_pins_write_condition(struct sim_slave *slave, uint8_t byte);
void sim_pins_reset_activity(struct sim_slave *slave);
void sim_pins_confirm(struct sim_slave *slave);
