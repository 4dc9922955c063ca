/* SPDX-License-Identifier: MIT */
/* The properties that most people want of a device, by its family. */
#ifndef OWSCTL_SCAN_KIND_H
#define OWSCTL_SCAN_KIND_H

#include <stdint.h>

struct scan_kind;

/* The kind of a family, or NULL. */
const struct scan_kind *scan_kind_of(uint8_t family);

#endif
