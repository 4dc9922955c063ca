/* SPDX-License-Identifier: MIT */
/* Runs single 1-Wire operations of a chip. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

struct ds2482_chip;

/* Run one operation of max_ns at most. Returns the status, or a negative errno. */
int ds2482_run(struct ds2482_chip *chip, uint8_t command, int parameter, long max_ns);
/* A byte where waits are timed: the status of it is not read. 0, or a negative errno. */
int ds2482_write_timed(struct ds2482_chip *chip, uint8_t byte);
int ds2482_read_timed(struct ds2482_chip *chip, uint8_t *byte);
/* Of the last status of an operation, or its error: what ds2482_run() returns. */
int ds2482_judge(struct ds2482_chip *chip, int status);
/*
 * The reason why an operation failed with err: -ETIMEDOUT: busy for ever, -ENXIO: the chip was
 * reset, -ENODEV, -EIO.
 */
int ds2482_diagnose(struct ds2482_chip *chip, int err);

/*
 * How many bytes to read so that the last one begins max_ns after the command; `between` bytes pass
 * before the reading begins. And so that a status behind the command is read then.
 */
unsigned ds2482_reading_on(const struct ds2482_chip *chip, long max_ns, unsigned between);
unsigned ds2482_reading_status(const struct ds2482_chip *chip, long max_ns);
/* Did the chip refuse a command? */
bool ds2482_is_refused(int err);
