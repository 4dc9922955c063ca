/* SPDX-License-Identifier: MIT */
/* Which serial port of this machine a target means. */
#pragma once

#include "hal/serial/port.h"

#define SERIAL_BY_ID "/dev/serial/by-id"

/*
 * The source of a target's port: a device file, or "" for the only one that by_id has. A device is
 * found again by what it is: the name below by_id that it had when it was opened first, since its
 * ttyUSBn may be another after a replug. 0, -EINVAL with the reason in why, -ENOMEM.
 */
int tty_source(const char *where, const char *by_id, struct serial_source *source, char *why,
               size_t why_size);
