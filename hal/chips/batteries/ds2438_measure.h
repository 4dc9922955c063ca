/* SPDX-License-Identifier: MIT */
/* What a DS2438 measures: temperature, two voltages, a current. */
#pragma once

#include "hal/chips/batteries/ds2438.h"

/* Measure a set of quantities, or take what has been measured for others: to value[]. */
int ds2438_measure(struct txn *txn, unsigned what);
/* For properties: the quantity that arg says. */
property_function ds2438_read_measured;
