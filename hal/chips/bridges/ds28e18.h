/* SPDX-License-Identifier: MIT */
/*
 * DS28E18: a bridge from 1-Wire to I2C with a sequencer. All that it is sent and answers has a
 * CRC16.
 */
#pragma once

#include "hal/chips/bridges/i2c.h"

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
