/* SPDX-License-Identifier: MIT */
/* The commands of a simulated DS2490, carried out on its wire. */
#pragma once

#include "hal/sim/usb/usb.h"

void sim_fifo_put(struct sim_fifo *fifo, uint8_t byte);
uint8_t sim_fifo_take(struct sim_fifo *fifo);

/*
 * What a communication command takes in the FIFO of commands; 0: the chip does not know it, or it
 * is not modelled.
 */
unsigned sim_ds2490_length(uint16_t code);
struct sim_wire *sim_ds2490_wire(const struct sim_ds2490 *chip);
void sim_ds2490_result(struct sim_ds2490 *chip, uint8_t result);
/* Begin the command that is first in the FIFO. */
void sim_ds2490_begin(struct sim_ds2490 *chip);
/* Until the next step of the work is done; -1: it waits for the host. INT64_MAX: without end. */
int64_t sim_ds2490_step_ns(const struct sim_ds2490 *chip);
/* Carry it out; it begins at chip->t. */
void sim_ds2490_step(struct sim_ds2490 *chip);
void sim_ds2490_end_pulse(struct sim_ds2490 *chip, int64_t t);
