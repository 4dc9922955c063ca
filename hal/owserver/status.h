/* SPDX-License-Identifier: MIT */
/* What owserver's return codes mean to the bus contract. */
#ifndef HAL_OWSERVER_STATUS_H
#define HAL_OWSERVER_STATUS_H

#include "hal/bus/bus.h"

/*
 * The bus error for a negative return code. -1 stands for "no such device or property", which the
 * caller tells apart: 1.
 */
int status_of(int32_t code, enum bus_op op);

#endif
