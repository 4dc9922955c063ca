/* SPDX-License-Identifier: MIT */
/* scan --alias FILE: names of devices from an alias file of OWFS (owfs_alias(5)). */
#ifndef OWSCTL_SCAN_ALIAS_H
#define OWSCTL_SCAN_ALIAS_H

#include "src/scan/device.h"

/*
 * Give the devices that were found the names that the file has for their ids; these go before an
 * alias that the target has. Prints the lines that name no device that was found. CTL_DONE, or
 * CTL_FAILED after printing why the file cannot be read.
 */
int scan_aliases(const char *file, struct scan *scan);

#endif
