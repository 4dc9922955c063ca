/* SPDX-License-Identifier: MIT */
/* What a simulated serial adapter does: answers to the host, and its wire. */
#pragma once

#include "hal/sim/serial/serial.h"

/* An answer that begins at t, or after those before. */
void sim_serial_answer(struct sim_serial *serial, uint8_t byte, int64_t t);
/* On the wire at now: a reset pulse (presence), a slot (the level as sampled). */
bool sim_serial_reset(struct sim_serial *serial, bool overdrive, int64_t now);
bool sim_serial_slot(struct sim_serial *serial, bool out, bool overdrive, int64_t now);
bool sim_serial_is_short(struct sim_serial *serial);
void sim_serial_strong(struct sim_serial *serial, bool on, int64_t now);
