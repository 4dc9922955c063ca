/* SPDX-License-Identifier: MIT */
/* The kernel's I2C adapters, /dev/i2c-N, through libi2c (SMBus calls) and I2C_RDWR. */
#pragma once

#include "hal/ds2482/i2c.h"

/*
 * Allocates. 0; -ENOMEM; -EOPNOTSUPP built without libi2c; -ENOTTY no I2C adapter; -errno of
 * opening the device.
 */
int i2c_dev_open(const char *path, struct i2c_adapter **adapter);
