/* SPDX-License-Identifier: MIT */
/*
 * The units of time: every time and every span here is in nanoseconds.
 *
 * Room hal/base: what every room may need: units of time, threads, bells, a ring of messages. Uses
 * no other.
 */
#pragma once

#include <stdint.h>

#define NS_PER_S INT64_C(1000000000)
#define NS_PER_MS INT64_C(1000000)

static inline int64_t earlier_ns(int64_t a, int64_t b)
{
	return a < b ? a : b;
}
