/* SPDX-License-Identifier: MIT */
/* The line of a simulated serial adapter: bytes of the host, and its own. */
#pragma once

#include "hal/sim/serial/serial.h"

void sim_serial_init(struct sim_serial *serial, enum sim_serial_kind kind, struct sim_net *net);
/* The host sends a byte at this speed; the line has it after those before. */
void sim_serial_send(struct sim_serial *serial, uint8_t byte, uint32_t baud, int64_t now);
/* The host holds the line low for longer than a byte. */
void sim_serial_break(struct sim_serial *serial, int64_t now);
/* When the next byte has come to the host; INT64_MAX: none is on its way. */
int64_t sim_serial_due(const struct sim_serial *serial);
/* Take it: what a host at this speed makes of it. */
uint8_t sim_serial_take(struct sim_serial *serial, uint32_t baud);
