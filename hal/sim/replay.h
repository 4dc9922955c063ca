/* SPDX-License-Identifier: MIT */
/* Scheme "replay": a recording of owsctl record in place of a wire, or of an owserver. */
#pragma once

#include "hal/bus/bus.h"

extern const struct bus_ops replay_bus;
