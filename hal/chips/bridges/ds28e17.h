/* SPDX-License-Identifier: MIT */
/* DS28E17: a bridge from 1-Wire to I2C. What it answers has no checksum. */
#pragma once

#include "hal/chips/bridges/i2c.h"

#define DS28E17_CODE 0x19

/* One I2C transaction, in one of 1-Wire. */
int ds28e17_exchange(struct txn *txn, const struct i2c_transfer *transfer);
