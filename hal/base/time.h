/* SPDX-License-Identifier: MIT */
/*
 * The units of time: every time and every span here is in nanoseconds.
 *
 * Room hal/base: what every room may need: units of time, threads, bells, a ring of messages, the
 * text of a file.
 */
#pragma once

#include <stdint.h>
#include <time.h>

#define NS_PER_S INT64_C(1000000000)
#define NS_PER_MS INT64_C(1000000)

static inline int64_t earlier_ns(int64_t a, int64_t b)
{
	return a < b ? a : b;
}

static inline int64_t later_ns(int64_t a, int64_t b)
{
	return a > b ? a : b;
}

static inline struct timespec timespec_of(int64_t ns)
{
	return (struct timespec){.tv_sec = (time_t)(ns / NS_PER_S),
	                         .tv_nsec = (long)(ns % NS_PER_S)};
}

static inline void clock_pause(int64_t ns)
{
	const struct timespec t = timespec_of(ns);

	nanosleep(&t, NULL);
}

/* What a clock of clock_gettime() has. */
static inline int64_t clock_ns(clockid_t clock)
{
	struct timespec t;

	clock_gettime(clock, &t);
	return (int64_t)t.tv_sec * NS_PER_S + t.tv_nsec;
}
