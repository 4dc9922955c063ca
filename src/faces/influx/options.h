/* SPDX-License-Identifier: MIT */
/* What stands in the Influx block, kept over the time in which the file is read again. */
#pragma once

#include <stdint.h>

struct face;

/* All zero but for what is set: two can be compared as memory. */
struct push_options {
	char url[256]; /* "": there is no block */
	char token_file[256], measurement[64];
	int64_t every_ns, clock_wait_ns;
};

void push_options_take(struct push_options *options, const struct face *face);
