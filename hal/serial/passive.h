/* SPDX-License-Identifier: MIT */
/* The passive kind of serial adapter. */
#pragma once

#include "hal/serial/master.h"

extern const struct serial_kind serial_passive;
