/* SPDX-License-Identifier: MIT */
/* Scheme "i2c": `i2c:/dev/i2c-1`, `i2c:/dev/i2c-1:0x18`, `i2c:/dev/i2c-1:0x18.3`, `i2c:auto`. */
#pragma once

#include "hal/wire/link.h"

/* Scheme "i2c": over hal/ds2482/i2c_dev.h. */
extern const struct link_master_ops ds2482_i2c_master;

/* link_master_ops.trouble: at most one look a minute. */
void ds2482_trouble(struct link_master *master, bool failed, char *text, size_t size);
