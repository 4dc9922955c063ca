/* SPDX-License-Identifier: MIT */
/*
 * A curve: what a quantity does over time, as a pure function of it. Idle time costs nothing.
 * Times are ns since the start of the simulation.
 */
#pragma once

#include <stddef.h>
#include <stdint.h>

enum sim_shape {
	SIM_CONSTANT, /* a */
	SIM_RAMP,     /* from a at start_ns to b at start_ns + span_ns, then b */
	SIM_SINE,     /* a + b * sin(2 pi (t - start_ns) / span_ns) */
	SIM_SQUARE,   /* a for the first half of each span_ns, b for the second */
	SIM_STEPS,    /* step[i].value from start_ns + step[i].at_ns on; every span_ns if > 0 */
};

#define SIM_MAX_STEPS 16
struct sim_step {
	int64_t at_ns; /* ascending, the first is 0 */
	double value;
};

struct sim_curve {
	enum sim_shape shape;
	double a, b;
	int64_t start_ns, span_ns;
	unsigned steps;
	struct sim_step step[SIM_MAX_STEPS];
};

struct sim_curve sim_constant(double value);
/* The nearest whole number, halves away from zero, at most 2^53 either way; 0 for a NaN. */
int64_t sim_round(double value);
double sim_curve_at(const struct sim_curve *curve, int64_t t);
/* When the value jumps next after t; INT64_MAX: never (a smooth curve does not jump). */
int64_t sim_curve_next(const struct sim_curve *curve, int64_t t);
/* Jumps downward (below 0.5 from above) in (from, to]: the falling edges of a logic level. */
uint64_t sim_curve_falls(const struct sim_curve *curve, int64_t from, int64_t to);
