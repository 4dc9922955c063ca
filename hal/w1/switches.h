/* SPDX-License-Identifier: MIT */
/* DS2405, DS2406, DS2408 and DS2413. */
#pragma once

#include "hal/w1/part.h"

extern const struct w1_driver w1_switches[];
