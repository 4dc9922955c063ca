/* SPDX-License-Identifier: MIT */
/* Serial ports of this machine, by termios. */
#pragma once

#include "hal/serial/port.h"

/* Open a device. -EADDRINUSE: another owsd has it, -EBUSY: a program wants it alone. */
int tty_open(const char *path, const struct bus_env *env, struct serial_port **port, int *holder);
