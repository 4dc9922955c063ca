/* SPDX-License-Identifier: MIT */
/*
 * Two masters on one chip break each other's transactions, and i2c-dev keeps out kernel drivers
 * only. So the process that drives the chip at an address locks the byte of that number in the
 * adapter's device file. The lock works between all users, ends with its holder, and leaves nothing
 * behind.
 */
#pragma once

#include <stdbool.h>
#include <stdint.h>

/*
 * Lock the chip. 0; -EADDRINUSE: another holder has the lock, *holder is its process id, or 0 if
 * that is not known or the holder is this process. fd is open for reading and writing. Never
 * blocks.
 */
int chip_lock(int fd, uint8_t address, int *holder);
void chip_unlock(int fd, uint8_t address);
/* Would chip_lock() be refused? */
bool chip_locked(int fd, uint8_t address);
