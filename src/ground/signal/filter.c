/* SPDX-License-Identifier: MIT */
/* A low-pass filter of first order for samples that come at irregular times. */
#include <math.h>

#include "src/ground/signal/filter.h"

double filter_sample(struct filter *filter, double seconds, double sample, int64_t at_ns)
{
	double way, share;

	if (filter->begun && at_ns <= filter->at_ns)
		return filter->value;
	way = sample - filter->value;
	share = seconds > 0 ? -expm1((double)(filter->at_ns - at_ns) / 1e9 / seconds) : 1;
	if (!filter->begun || share >= 1 || !isfinite(way))
		filter->value = sample;
	else
		filter->value += share * way;
	filter->begun = true;
	filter->at_ns = at_ns;
	return filter->value;
}
