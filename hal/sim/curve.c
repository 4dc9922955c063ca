/* SPDX-License-Identifier: MIT */
/* Curves: the value of a quantity at a time, and the time of its next change. */
#include "hal/sim/curve.h"

#define HALF_PI 1.57079632679489661923
#define EXACT 9007199254740992.0 /* 2^53: up to here a double has every whole number */

struct sim_curve sim_constant(double value)
{
	return (struct sim_curve){.shape = SIM_CONSTANT, .a = value};
}

/* The time since the current repetition began. */
static int64_t phase_of(const struct sim_curve *curve, int64_t t)
{
	int64_t since = t - curve->start_ns;

	if (since < 0)
		return 0;
	return curve->span_ns > 0 ? since % curve->span_ns : since;
}

/* The sine of so many turns, 0 to 1. libm would cost the daemon 300 KiB for this function alone. */
static double sine_of(double turns)
{
	int quarter = (int)(turns * 4);
	double x = turns * 4 - quarter, square, term, sum;

	if (quarter & 1)
		x = 1 - x;
	/* near zero the sine's series, in the other half of the quarter the cosine's */
	int n = x > 0.5 ? 0 : 1;
	double angle = (n ? x : 1 - x) * HALF_PI;
	square = angle * angle;
	sum = term = n ? angle : 1;
	for (; n < 15; n += 2) {
		term *= -square / ((n + 1) * (n + 2));
		sum += term;
	}
	return quarter & 2 ? -sum : sum;
}

int64_t sim_round(double value)
{
	if (value >= EXACT || value <= -EXACT)
		return value > 0 ? (int64_t)EXACT : -(int64_t)EXACT;
	return value == value ? (int64_t)(value < 0 ? value - 0.5 : value + 0.5) : 0;
}

static unsigned step_at(const struct sim_curve *curve, int64_t since)
{
	unsigned i = 0;

	while (i + 1 < curve->steps && curve->step[i + 1].at_ns <= since)
		i++;
	return i;
}

double sim_curve_at(const struct sim_curve *curve, int64_t t)
{
	double part;

	switch (curve->shape) {
	case SIM_CONSTANT:
		break;
	case SIM_RAMP:
		if (t <= curve->start_ns)
			return curve->a;
		if (t - curve->start_ns >= curve->span_ns)
			return curve->b;
		part = (double)(t - curve->start_ns) / (double)curve->span_ns;
		return curve->a + (curve->b - curve->a) * part;
	case SIM_SINE:
		part = (double)phase_of(curve, t) / (double)curve->span_ns;
		return curve->a + curve->b * sine_of(part);
	case SIM_SQUARE:
		return phase_of(curve, t) < curve->span_ns / 2 ? curve->a : curve->b;
	case SIM_STEPS:
		return curve->step[step_at(curve, phase_of(curve, t))].value;
	}
	return curve->a;
}

int64_t sim_curve_next(const struct sim_curve *curve, int64_t t)
{
	int64_t since = phase_of(curve, t),
		base = t < curve->start_ns ? curve->start_ns : t - since;
	unsigned i;

	switch (curve->shape) {
	case SIM_CONSTANT:
	case SIM_RAMP:
	case SIM_SINE:
		break;
	case SIM_SQUARE:
		return base + (since < curve->span_ns / 2 ? curve->span_ns / 2 : curve->span_ns);
	case SIM_STEPS:
		i = step_at(curve, since);
		if (i + 1 < curve->steps)
			return base + curve->step[i + 1].at_ns;
		if (curve->span_ns > 0)
			return base + curve->span_ns;
		break;
	}
	return INT64_MAX;
}

static uint64_t falls_stepwise(const struct sim_curve *curve, int64_t from, int64_t to)
{
	uint64_t falls = 0;
	double level = sim_curve_at(curve, from);

	for (int64_t t = sim_curve_next(curve, from); t <= to; t = sim_curve_next(curve, t)) {
		double now = sim_curve_at(curve, t);

		falls += level >= 0.5 && now < 0.5;
		level = now;
	}
	return falls;
}

uint64_t sim_curve_falls(const struct sim_curve *curve, int64_t from, int64_t to)
{
	uint64_t whole = 0;
	int64_t span = curve->span_ns;

	if (from < curve->start_ns)
		from = curve->start_ns;
	if (span > 0 && (curve->shape == SIM_SQUARE || curve->shape == SIM_STEPS) &&
	    to - from > 2 * span) {
		int64_t times = (to - from) / span - 1;

		whole = (uint64_t)times * falls_stepwise(curve, from, from + span);
		from += times * span;
	}
	return whole + falls_stepwise(curve, from, to);
}
