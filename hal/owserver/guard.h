/* SPDX-License-Identifier: MIT */
/*
 * Readings that mean a power fault: a thermometer that lost its supply answers 85 (its power-on
 * scratchpad), one whose conversion starved 127.94. The native bus sees it by the scratchpad; of a
 * server's reading there is the number alone. Which properties are such a thermometer's stands in
 * hal/chips (property.measures).
 */
#pragma once

#include <stdbool.h>
#include <stdint.h>

struct guard {
	double last;     /* last reading that was believed */
	int64_t last_ns; /* when; 0: none yet */
};
/*
 * True if a reading means a power fault. 127.9375 always does, in any rounding. 85 does unless the
 * room was near it when last measured (within 5 degrees, no longer ago than 60 s): a boiler passes
 * 85 on its way.
 */
bool guard_refuses(struct guard *guard, double degrees, int64_t now_ns);
