/* SPDX-License-Identifier: MIT */
/* Runs whole 1-Wire operations of a chip. */
#ifndef HAL_DS2482_RUN_H
#define HAL_DS2482_RUN_H

#include <stddef.h>
#include <stdint.h>

struct ds2482_chip;

/* Run one operation of max_ns at most. Returns the status, or a negative errno. */
int ds2482_run(struct ds2482_chip *chip, uint8_t command, int parameter, long max_ns);
int ds2482_write_block(struct ds2482_chip *chip, const uint8_t *data, size_t n, long max_ns);
int ds2482_read_block(struct ds2482_chip *chip, uint8_t *data, size_t n, long max_ns);
/*
 * The reason why an operation failed with err: -ETIMEDOUT: busy for ever, -ENXIO: the chip was
 * reset, -ENODEV, -EIO.
 */
int ds2482_diagnose(struct ds2482_chip *chip, int err);

#endif
