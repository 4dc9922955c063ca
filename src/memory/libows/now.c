/* SPDX-License-Identifier: MIT */
/* The clock of owsd and its consumers. */
#include "hal/base/time.h"
#include "src/public/ows.h"

int64_t ows_now(void)
{
	return clock_ns(CLOCK_BOOTTIME);
}
