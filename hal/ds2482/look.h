/* SPDX-License-Identifier: MIT */
/* What the kernel's files show of an I2C adapter and its chips, without a byte on the wires. */
#pragma once

#include <stddef.h>
#include <stdint.h>

#define I2C_DEV_ROOT "/dev"
#define I2C_SYS_ROOT "/sys/bus/i2c/devices"

/*
 * 1: the adapter's device file may be read and written; and of the chips at 0x18 + n, for each bit
 * n of chips, at least one is free if any bit is set: no kernel driver is bound to it and no
 * process holds its lock (chip_lock.h). *mark is mixed with what was seen. sys: I2C_SYS_ROOT.
 */
int i2c_look(const char *path, const char *sys, uint8_t chips, uint64_t *mark);
/* Find the kernel driver of the chip ("ds2482", or ""), and the chip's name there ("1-0018"). */
void i2c_driver(const char *path, const char *sys, uint8_t address, char *driver,
                size_t driver_size, char *client, size_t client_size);
/* Write the numbers N of all files i2c-N in root, rising; at most max. */
unsigned i2c_list(const char *root, unsigned *numbers, unsigned max);
