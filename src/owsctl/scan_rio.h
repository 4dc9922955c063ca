/* SPDX-License-Identifier: MIT */
/* scan --rio: makes a configuration of the devices that were found. */
#ifndef OWSCTL_SCAN_RIO_H
#define OWSCTL_SCAN_RIO_H

#include <stdbool.h>

#include "src/owsctl/scan_item.h"

struct scan;

/*
 * Print a configuration with that TargetName, which may be several targets. CTL_DONE, or CTL_FAILED
 * after printing why; then stdout got nothing.
 */
int scan_rio(const struct scan *scan, const char *target, bool several, struct scan_choice choice);

#endif
