/* SPDX-License-Identifier: MIT */
/*
 * The wall clock beside boot time: how far they are apart, when that changes, and whether the
 * kernel calls the wall clock synchronised. A Raspberry Pi without a clock of its own starts with
 * the time of its last shutdown, and learns the right one minutes later.
 */
#pragma once

#include <stdbool.h>
#include <stdint.h>

struct wall_clock {
	int64_t offset_ns; /* CLOCK_REALTIME minus CLOCK_BOOTTIME */
	bool trusted;      /* adjtimex(2) says that it is synchronised, or it was before */
	int64_t asked_ns;  /* when the kernel was asked last */
};

/* Look for the first time. */
void wall_clock_open(struct wall_clock *clock);
/*
 * Look again, each second and before a time is written. True: the clock was set, or is trusted
 * now, or no longer. Two readings of the same clock differ by the time between the calls; less than
 * 50 ms is no step.
 */
bool wall_clock_look(struct wall_clock *clock, int64_t now_ns);

/* Pure: what a look at the two clocks says of the known relation. */
bool wall_clock_step(struct wall_clock *clock, int64_t offset_ns, bool synchronised);
