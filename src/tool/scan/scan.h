/* SPDX-License-Identifier: MIT */
/* Asks a target for its devices and their properties. Blocking, as long as the target allows. */
#pragma once

#include "src/tool/scan/device.h"

struct target;

/*
 * Find all devices, and where they are; they are read by scan_read(). 0, -ENOMEM, -E2BIG: there are
 * more than 512 couplers, or the error of the target. Free the scan in any case.
 */
int scan_find(struct target *target, struct scan *scan);
/*
 * Read devices: all requests at once, so that all thermometers convert at the same time where the
 * bus can do that. fresh: past the cache. 0, -ENOMEM, or -ETIMEDOUT: the target does not answer any
 * more; what it answered before is there.
 */
int scan_read(struct target *target, struct scan_device *devices, unsigned count, bool fresh);
/* The device that a path names, as the root lists it; false: it names none. */
bool scan_device_of(const char *path, struct scan_device *device);
void scan_free(struct scan *scan);

/*
 * The i-th of the properties that most people want of the device; false: it has no more. Where the
 * chips of a family differ, it has none before it was read.
 */
bool scan_property(const struct scan_device *device, unsigned i, struct scan_property *property);
/* The property that says which chip it is, where its family code does not; else NULL. */
const char *scan_identity(uint8_t family);
