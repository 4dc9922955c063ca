/* SPDX-License-Identifier: MIT */
/* Sums over time, of states that last and of sums. */
#include "src/history/file/rollup.h"

#include <math.h>

#include "src/public/ows.h"

/* Good values from least to most, of which `last` came last. */
static void widen(struct rollup *sum, double least, double most, double last)
{
	if (!sum->has_value || least < sum->least)
		sum->least = least;
	if (!sum->has_value || most > sum->most)
		sum->most = most;
	sum->last = last;
	sum->has_value = true;
}

static void see_state(struct rollup *sum, const struct rollup_state *state)
{
	if (!state->known)
		return;
	if (!sum->has_quality || state->quality < sum->worst)
		sum->worst = state->quality;
	sum->has_quality = true;
	if (ows_good(state->quality) && !isnan(state->value))
		widen(sum, state->value, state->value, state->value);
}

void rollup_hold(struct rollup *sum, const struct rollup_state *state, int64_t us)
{
	if (us <= 0 || !state->known)
		return;
	see_state(sum, state);
	sum->known_us += us;
	if (!ows_good(state->quality))
		return;
	sum->good_us += us;
	if (isnan(state->value))
		return;
	sum->sum += state->value * (double)us;
	sum->sum_us += us;
}

void rollup_value(struct rollup *sum, const struct rollup_state *state)
{
	see_state(sum, state);
	sum->count++;
}

void rollup_add(struct rollup *sum, const struct rollup *later)
{
	if (later->has_quality && (!sum->has_quality || later->worst < sum->worst))
		sum->worst = later->worst;
	sum->has_quality |= later->has_quality;
	if (later->has_value)
		widen(sum, later->least, later->most, later->last);
	sum->sum += later->sum;
	sum->sum_us += later->sum_us;
	sum->good_us += later->good_us;
	sum->known_us += later->known_us;
	sum->count += later->count;
}

double rollup_mean(const struct rollup *sum)
{
	if (!sum->has_value)
		return NAN;
	return sum->sum_us > 0 ? sum->sum / (double)sum->sum_us : sum->last;
}
