/* SPDX-License-Identifier: MIT */
/* The DS2480B as a kind of serial adapter. */
#pragma once

#include "hal/serial/master.h"

extern const struct serial_kind serial_ds2480b;
