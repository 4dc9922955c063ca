/* SPDX-License-Identifier: MIT */
/*
 * When an operation of a chip really ends. The data sheet leaves 5 % to both sides of the typical
 * time. Where the status is read on after an operation, the first byte that says idle tells it of
 * this chip, in bytes of this I2C bus. The latest of some such looks counts, which come with every
 * search. What follows from it is only how many bytes to let pass before the next command: the chip
 * refuses one that comes too early (1WB, "command not acknowledged"), and does not execute it.
 *
 * Nothing here waits or uses the bus.
 */
#pragma once

#include <stdint.h>

enum ds2482_operation { DS2482_OF_RESET, DS2482_OF_BYTE };

#define DS2482_LOOKS 8

/* Of one chip; zero: nothing is known. */
struct ds2482_ends {
	struct {
		uint8_t idle[DS2482_LOOKS]; /* the first byte of status that said so, from 0 */
		uint8_t looks, next;        /* how many are known; the next to be overwritten */
	} of[2];                            /* by enum ds2482_operation */
	uint8_t doubts; /* bytes to wait longer than that, after it was too early */
};

/* n bytes of status, read in one message after an operation of max_ns at most. */
void ds2482_saw_end(struct ds2482_ends *ends, long max_ns, const uint8_t *status, unsigned n);
/*
 * How many bytes to read in one message between an operation and the next command: `longest`, or
 * fewer if that is known to be enough; `least` at least.
 */
unsigned ds2482_pause(const struct ds2482_ends *ends, enum ds2482_operation operation,
                      unsigned least, unsigned longest);
/* The chip refused a command: what is known is of no use. */
void ds2482_forget_ends(struct ds2482_ends *ends);
