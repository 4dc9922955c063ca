/* SPDX-License-Identifier: MIT */
/* What a DS2438 measures: temperature, two voltages, a current. */
#ifndef HAL_CHIPS_DS2438_MEASURE_H
#define HAL_CHIPS_DS2438_MEASURE_H

#include "hal/wire/txn.h"

/* Measure a set of quantities, or take what has been measured for others: to value[]. */
int ds2438_measure(struct txn *txn, unsigned what);

#endif
