/* SPDX-License-Identifier: MIT */
/* scan --rio: makes a configuration of the devices that were found. */
#ifndef OWSCTL_SCAN_RIO_H
#define OWSCTL_SCAN_RIO_H

#include <stdbool.h>

struct scan;

/*
 * Print a configuration with that TargetName, which may be several targets; without outputs if
 * inputs_only. CTL_DONE, or CTL_FAILED after printing why; then stdout got nothing.
 */
int scan_rio(const struct scan *scan, const char *target, bool several, bool inputs_only);

#endif
