/* SPDX-License-Identifier: MIT */
/*
 * Values, their quality and age, targets, devices and counters in the text format of OpenMetrics
 * 1.0, or in the one of Prometheus, 0.0.4. A value that is not good is absent: an old one would
 * look like a new one.
 */
#pragma once

#include <stdbool.h>
#include <stdio.h>

#include "src/public/ows.h"

#define METRICS_TYPE "application/openmetrics-text; version=1.0.0; charset=utf-8"

struct metrics {
	const char *instance;
	struct ows *h;
	bool lost;             /* the caller knows that owsd is not there: no value is printed */
	bool prometheus;       /* its format, without an end mark */
	char *const *patterns; /* of signals; pattern_count 0: all */
	int pattern_count;
};

/*
 * Print the next part: at most so many samples of signals and devices. *at is 0 before the first
 * part; the table must stay the same until the last. True: there is more.
 */
bool metrics_print(FILE *out, const struct metrics *metrics, int *at, int most);
