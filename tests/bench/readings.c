/* SPDX-License-Identifier: MIT */
/* Thermometers that drift. */
#include "tests/bench/readings.h"

#include <stdio.h>
#include <stdlib.h>

struct readings readings_begin(unsigned count, double change)
{
	struct readings r = {.count = count, .change = change, .state = 1};

	r.values = malloc(count * sizeof(*r.values));
	if (!r.values) {
		perror("readings");
		exit(1);
	}
	for (unsigned i = 0; i < count; i++)
		r.values[i] = 20 + i % 100 / 16.0;
	return r;
}

void readings_end(struct readings *r)
{
	free(r->values);
	r->values = NULL;
}

bool readings_next(struct readings *r, unsigned i)
{
	r->state = r->state * 6364136223846793005u + 1442695040888963407u;
	if ((double)(r->state >> 33) / (double)(1u << 31) >= r->change)
		return false;
	/* back to the middle where it has gone far */
	if (r->values[i] > 60 || r->values[i] < -20)
		r->values[i] = 20;
	else
		r->values[i] += r->state & 1u << 20 ? 1 / 16.0 : -1 / 16.0;
	return true;
}
