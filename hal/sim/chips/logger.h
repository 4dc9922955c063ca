/* SPDX-License-Identifier: MIT */
/* What the simulated loggers share: a clock with a battery of its own, and their memory. */
#pragma once

#include "hal/sim/chips/scratchpad.h"

/* The bytes of a date; a logger without day of the week leaves it out. */
enum { SIM_SECONDS, SIM_MINUTES, SIM_HOURS, SIM_DAY, SIM_DATE, SIM_MONTH, SIM_YEAR, SIM_TIME };

struct sim_clock {
	int64_t zero;    /* it was 1900-01-01 00:00:00 */
	int64_t stopped; /* the time since then, if the oscillator stands; -1: it runs */
	bool twelve;     /* hours as AM and PM */
	uint8_t day;     /* what the first day of that week is called, 0 to 6 */
};

/* It is the first of January 2000, as from the factory. */
void sim_clock_init(struct sim_clock *clock);
/* BCD as in the registers: the century is bit 7 of the month. */
void sim_clock_get(const struct sim_clock *clock, int64_t t, uint8_t bcd[SIM_TIME]);
void sim_clock_set(struct sim_clock *clock, int64_t t, const uint8_t bcd[SIM_TIME]);
void sim_clock_run(struct sim_clock *clock, int64_t t, bool run);
