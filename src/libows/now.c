/* SPDX-License-Identifier: MIT */
/* The clock of owsd and its consumers. */
#include <time.h>

#include "hal/base/time.h"
#include "src/libows/ows.h"

int64_t ows_now(void)
{
	struct timespec ts;

	clock_gettime(CLOCK_BOOTTIME, &ts);
	return (int64_t)ts.tv_sec * NS_PER_S + ts.tv_nsec;
}
