/* SPDX-License-Identifier: MIT */
/* Reads devices by several connections to the same target. */
#pragma once

#include <stdbool.h>

struct scan;
struct target;

/*
 * As scan_read() of all devices, by several connections to the target of like at once, where each
 * waits for the conversions of its own devices. 0, or the error of one of them.
 */
int scan_read_parallel(const struct target *like, struct scan *scan, bool fresh);
