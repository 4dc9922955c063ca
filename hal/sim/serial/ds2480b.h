/* SPDX-License-Identifier: MIT */
/* The DS2480B of a simulated serial adapter. */
#pragma once

#include "hal/sim/serial/serial.h"

/* Into the state after power-on. */
void sim_ds2480b_reset(struct sim_serial *serial, int64_t t);
/* Carry out a byte that has come by t; returns when it is done. */
int64_t sim_ds2480b_byte(struct sim_serial *serial, uint8_t byte, int64_t t);
