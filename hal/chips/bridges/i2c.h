/* SPDX-License-Identifier: MIT */
/* What a bridge is asked to do on its I2C bus. */
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
