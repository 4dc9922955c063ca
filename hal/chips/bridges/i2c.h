/* SPDX-License-Identifier: MIT */
/* The bridges from 1-Wire to I2C, and what they are asked to do on that bus. */
#pragma once

#include "hal/wire/txn.h"

#define I2C_AT_ONCE 32

/*
 * Write n bytes, read m, or both with a repeated START between. -EIO: the address or a byte was
 * not acknowledged; -EBADMSG: the bridge did not take it, or its answer is wrong.
 */
struct i2c_transfer {
	uint8_t address; /* 7 bits */
	const uint8_t *out;
	unsigned n;
	uint8_t *in;
	unsigned m;
};

/* DS28E17: what it answers has no checksum. */
#define DS28E17_CODE 0x19

/* One I2C transaction, in one of 1-Wire. */
int ds28e17_exchange(struct txn *txn, const struct i2c_transfer *transfer);

/* DS28E18: it has a sequencer. All that it is sent and answers has a CRC16. */
#define DS28E18_CODE 0x56

/*
 * One I2C transaction, which takes up to three of 1-Wire: *part, 0 at first, is which is next.
 * Returns TXN_MORE between them.
 */
int ds28e18_exchange(struct txn *txn, const struct i2c_transfer *transfer, uint8_t *part);
/* Is this the id of those that have just got power? */
bool ds28e18_asleep(const uint8_t rom[8]);
/* Gives all of these on the wire their own ids. 0 or an error. */
int ds28e18_wake(struct txn *txn);
