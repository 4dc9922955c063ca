/* SPDX-License-Identifier: MIT */
/* Inside the driver. Errors are those of hal/wire/link.h; those of io.h are those of i2c.h. */
#pragma once

#include "hal/base/time.h"
#include "hal/ds2482/ds2482.h"

#define DS2482_NO_PARAMETER (-1)

/* How long a wire is without supply, so that all slaves forget their state. */
#define DS2482_POWER_OFF_NS (500 * NS_PER_MS)
#define DS2482_POWER_ON_NS (10 * NS_PER_MS)

/* A chip that is busy for so much longer than it may be stays so; and how often to look. */
#define DS2482_STUCK_NS (10 * NS_PER_MS)
#define DS2482_POLL_NS INT64_C(200000)
