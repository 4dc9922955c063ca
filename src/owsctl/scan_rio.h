/* SPDX-License-Identifier: MIT */
/* scan --rio: a configuration made of what was found. */
#ifndef OWSCTL_SCAN_RIO_H
#define OWSCTL_SCAN_RIO_H

#include <stdbool.h>

struct scan;

/*
 * Print a configuration with that TargetName, which may be several; without outputs if inputs_only.
 * CTL_DONE, or CTL_FAILED after having said why; then nothing was printed.
 */
int scan_rio(const struct scan *scan, const char *target, bool several, bool inputs_only);

#endif
