/* SPDX-License-Identifier: MIT */
/* Scheme "sim". */
#ifndef HAL_SIM_BUS_H
#define HAL_SIM_BUS_H

#include "hal/bus/bus.h"

extern const struct bus_ops sim_bus;

#endif
