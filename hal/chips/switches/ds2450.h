/* SPDX-License-Identifier: MIT */
/* What a conversion of all DS2450 at once needs of the chip (data sheet 19-5125). */
#pragma once

#include "hal/chips/area.h"

/* All four channels with 16 bits. */
extern const struct conversion ds2450_conversion;

/* What is known of the chip (device.own). */
struct ds2450 {
	bool por_clear;      /* no channel's power-on flag is set */
	int64_t measured_ns; /* when its last conversion began; 0: none is known */
};
static inline struct ds2450 *ds2450_of(const struct device *device)
{
	return device->own;
}
