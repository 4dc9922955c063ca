/* SPDX-License-Identifier: MIT */
/* An I2C adapter in front of another, or in place of one. */
#pragma once

#include "hal/trace/lines.h"

/* As tap.adapter; under NULL: it is replayed. */
struct i2c_adapter *trace_adapter_of(struct tap *tap, const struct bus_env *env,
                                     struct i2c_adapter *under);
