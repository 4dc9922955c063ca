/* SPDX-License-Identifier: MIT */
/* The properties that most people want of a device, by its family. */
#ifndef SCAN_KIND_H
#define SCAN_KIND_H

#include <stdbool.h>
#include <stdint.h>

struct scan_kind;

/* The kind of a family, or NULL. */
const struct scan_kind *scan_kind_of(uint8_t family);
/* Does its code not decide which chip it is? Then devices have the property "identity". */
bool scan_has_identity(uint8_t family);

#endif
