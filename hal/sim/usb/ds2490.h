/* SPDX-License-Identifier: MIT */
/* The endpoints of a simulated DS2490: its transfers, in time. */
#pragma once

#include "hal/sim/usb/usb.h"

/* Power on, not configured. */
void sim_ds2490_init(struct sim_ds2490 *chip, struct sim_net *net);

/*
 * Transfers. All return the bytes moved, or -ENODEV it is unplugged, -EPIPE a stall, -EAGAIN a NAK:
 * nothing yet, the host asks again until its time is over.
 */
int sim_ds2490_control(struct sim_ds2490 *chip, const uint8_t setup[8], uint8_t *data, size_t room,
                       int64_t now);
/* EP1. -EOVERFLOW: the packet has more bytes than there is room, and they are lost. */
int sim_ds2490_interrupt(struct sim_ds2490 *chip, uint8_t *data, size_t room, int64_t now);
/* EP2: whole packets are taken while there is room, perhaps less than all. */
int sim_ds2490_bulk_out(struct sim_ds2490 *chip, const uint8_t *data, size_t len, int64_t now);
/* EP3: all that is there, and no less. -EOVERFLOW: it was more than room, and is lost. */
int sim_ds2490_bulk_in(struct sim_ds2490 *chip, uint8_t *data, size_t room, int64_t now);
/* Carry out what is due. Each transfer does it too. */
void sim_ds2490_run(struct sim_ds2490 *chip, int64_t now);
/*
 * When the chip does its next step by itself on the host's clock; INT64_MAX: it does nothing, or
 * waits for the host.
 */
int64_t sim_ds2490_due(const struct sim_ds2490 *chip);
/* The interval at which a host asks EP1 in the alternate setting in force. */
int64_t sim_ds2490_poll_ns(const struct sim_ds2490 *chip);
/* All that the data sheet forbids, in one number. */
uint64_t sim_ds2490_forbidden(const struct sim_ds2490 *chip);
