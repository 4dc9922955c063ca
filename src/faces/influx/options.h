/* SPDX-License-Identifier: MIT */
/* What stands in the Influx block, kept over the time in which the file is read again. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

struct face;

struct push_options {
	char url[256]; /* "": there is no block */
	char token_file[256], measurement[64];
	int64_t every_ns, clock_wait_ns;
};

void push_options_take(struct push_options *options, const struct face *face);
bool push_options_same(const struct push_options *a, const struct push_options *b);
