/* SPDX-License-Identifier: MIT */
/* The properties that most people want of a device, by its family. */
#ifndef SCAN_KIND_H
#define SCAN_KIND_H

#include "src/scan/device.h"

/* The i-th of the family; false: it has no more. */
bool scan_property(uint8_t family, unsigned i, struct scan_property *property);
/* Does its code not decide which chip it is? Then devices have the property "identity". */
bool scan_has_identity(uint8_t family);

#endif
