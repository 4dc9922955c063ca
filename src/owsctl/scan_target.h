/* SPDX-License-Identifier: MIT */
/* Asks a target for its devices and their properties, for owsctl scan. */
#ifndef OWSCTL_SCAN_TARGET_H
#define OWSCTL_SCAN_TARGET_H

struct scan;
struct target;

/* Find all devices and read them. CTL_DONE, or CTL_FAILED after printing why. */
int scan_target(struct target *target, struct scan *scan);
void scan_free(struct scan *scan);

#endif
