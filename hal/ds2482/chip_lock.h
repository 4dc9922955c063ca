/* SPDX-License-Identifier: MIT */
/*
 * Two masters on one chip break each other's transactions, and i2c-dev keeps out kernel drivers
 * only. So whoever drives the chip at an address holds a lock on the adapter's device file, at the
 * byte of that number: for every user alike, gone with its holder, and nothing is left behind.
 */
#ifndef HAL_DS2482_CHIP_LOCK_H
#define HAL_DS2482_CHIP_LOCK_H

#include <stdbool.h>
#include <stdint.h>

/*
 * 0; -EADDRINUSE: another has it, *holder is its process id, 0 if that is not known, as
 * where it is another descriptor of this process. fd is open for reading and writing. Never blocks.
 */
int chip_lock(int fd, uint8_t address, int *holder);
void chip_unlock(int fd, uint8_t address);
/* Would chip_lock() find it taken? */
bool chip_locked(int fd, uint8_t address);

#endif
