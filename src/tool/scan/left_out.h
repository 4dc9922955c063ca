/* SPDX-License-Identifier: MIT */
/* What a device measures or switches besides the properties that most people want of it. */
#pragma once

#include <stddef.h>

#include "src/tool/scan/scan.h"

/*
 * The properties of the device that measure or switch, and are neither of those that most people
 * want nor another form of one, as "vis, B1-R1-A/pressure".
 */
void scan_left_out(const struct scan_device *device, char *out, size_t size);
