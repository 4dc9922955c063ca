/* SPDX-License-Identifier: MIT */
/* Which serial port of this machine a target means. */
#pragma once

#include "hal/serial/port.h"

#define SERIAL_NAMES "/dev/serial"
#define SERIAL_BY_ID SERIAL_NAMES "/by-id"

/* The only serial port by a name that stays. False: there is none, or there are several. */
bool tty_only(const char *names, char *path, size_t size);
/*
 * The source of a target's port: a device file, or "" for the only one that names/by-id has. A
 * device is found again by what it is: the name below names that it had when it was opened first,
 * since its ttyUSBn may be another after a replug. Of two adapters without a serial number, which
 * have one name below by-id, that is the one below by-path. A port that was opened is reported
 * where it is another adapter, or in another place, than the one before. 0, -EINVAL with the reason
 * in why, -ENOMEM.
 */
int tty_source(const char *where, const char *names, struct serial_source *source, char *why,
               size_t why_size);
