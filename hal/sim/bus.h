/* SPDX-License-Identifier: MIT */
/* Scheme "sim". */
#pragma once

#include "hal/bus/bus.h"

extern const struct bus_ops sim_bus;
