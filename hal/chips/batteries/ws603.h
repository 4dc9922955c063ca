/* SPDX-License-Identifier: MIT */
/*
 * WS603: a weather station that speaks through the memory of its DS2760. It is asked by writing to
 * that memory, also when it is read: so what it says is hidden. Who only looks at directories does
 * not write to a DS2760 that has no station.
 */
#pragma once

#include "hal/chips/property.h"

/* arg: what is asked for, and from bit 8 on which byte of the answer. */
property_function ws603_read_byte, ws603_read_bytes, ws603_read_wind;

enum { WS603_PARAMETERS = 0xa0, WS603_DATA };
