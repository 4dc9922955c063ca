/* SPDX-License-Identifier: MIT */
/* Runs whole 1-Wire operations of a chip. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct ds2482_chip;

/* Run one operation of max_ns at most. Returns the status, or a negative errno. */
int ds2482_run(struct ds2482_chip *chip, uint8_t command, int parameter, long max_ns);
int ds2482_write_block(struct ds2482_chip *chip, const uint8_t *data, size_t n);
int ds2482_read_block(struct ds2482_chip *chip, uint8_t *data, size_t n);
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
/* Does a message take longer than an operation of max_ns? Then nothing is read between two. */
bool ds2482_is_slow(const struct ds2482_chip *chip, long max_ns);
/* Did the chip refuse a command? */
bool ds2482_is_refused(int err);
/* Is time passed by reading on, and not by timed waits, between bytes that are written? */
bool ds2482_reads_on(const struct ds2482_chip *chip);
/* How many operations of so many messages fit in one transfer; 1 at least. */
size_t ds2482_batch(const struct ds2482_chip *chip, unsigned messages_each);
