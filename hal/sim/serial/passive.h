/* SPDX-License-Identifier: MIT */
/* A simulated passive serial adapter. */
#pragma once

#include "hal/sim/serial/serial.h"

/* A byte whose stop bit ends at t. */
void sim_passive_byte(struct sim_serial *serial, uint8_t byte, uint32_t baud, int64_t t);
