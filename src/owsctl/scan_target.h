/* SPDX-License-Identifier: MIT */
/* What owsctl scan asks a target for: its devices and their properties. */
#ifndef OWSCTL_SCAN_TARGET_H
#define OWSCTL_SCAN_TARGET_H

struct scan;
struct target;

/* Find all devices and read them. CTL_DONE, or CTL_FAILED after having said why. */
int scan_target(struct target *target, struct scan *scan);
void scan_free(struct scan *scan);

#endif
