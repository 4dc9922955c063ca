/* SPDX-License-Identifier: MIT */
/* Which driver has a slave, and what it gives of it. */
#pragma once

#include "hal/w1/part.h"

/* NULL: none. */
const struct w1_driver *w1_driver_of(const struct w1_slave *slave);
/* As driver_ops.offers. */
bool w1_offers(struct w1_slave *slave, const char *property, int element);
/* NULL: there is nothing that stands for it. */
const struct w1_part *w1_part_of(const struct w1_slave *slave, const char *area);
/* 1, 0, or an error: -EOPNOTSUPP it cannot be told, -ENODEV it is gone. */
int w1_in_alarm(struct w1_slave *slave);
