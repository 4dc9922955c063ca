/* SPDX-License-Identifier: MIT */
/* Maps owserver's return codes to errors of the bus contract. */
#pragma once

#include "hal/bus/bus.h"

/*
 * The bus error for a negative return code. 1 stands for code -1, "no such device or property": the
 * caller finds out which of them.
 */
int status_of(int32_t code, enum bus_op op);
