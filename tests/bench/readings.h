/* SPDX-License-Identifier: MIT */
/*
 * Readings of thermometers for the benches of history: the same in each run. A value stays or goes
 * up or down by 1/16, as that of a DS18B20 does.
 */
#pragma once

#include <stdbool.h>

struct readings {
	unsigned count;
	double change; /* how likely a reading is another one: 0 to 1 */
	double *values;
	unsigned long long state;
};

/* Allocates; ends the program where there is no memory. */
struct readings readings_begin(unsigned count, double change);
void readings_end(struct readings *readings);
/* Read thermometer i again. Is it another value? */
bool readings_next(struct readings *readings, unsigned i);
