/* SPDX-License-Identifier: MIT */
#include "curve.h"

#include <math.h>

#define TWO_PI 6.28318530717958647692

struct sim_curve sim_constant(double value)
{
	return (struct sim_curve){.shape = SIM_CONSTANT, .a = value};
}

/* Time since the begin of the current repetition. */
static int64_t phase(const struct sim_curve *curve, int64_t t)
{
	int64_t since = t - curve->start_ns;

	if (since < 0)
		return 0;
	return curve->span_ns > 0 ? since % curve->span_ns : since;
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
		part = (double)phase(curve, t) / (double)curve->span_ns;
		return curve->a + curve->b * sin(TWO_PI * part);
	case SIM_SQUARE:
		return phase(curve, t) < curve->span_ns / 2 ? curve->a : curve->b;
	case SIM_STEPS:
		return curve->step[step_at(curve, phase(curve, t))].value;
	}
	return curve->a;
}

int64_t sim_curve_next(const struct sim_curve *curve, int64_t t)
{
	int64_t since = phase(curve, t), base = t < curve->start_ns ? curve->start_ns : t - since;
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
