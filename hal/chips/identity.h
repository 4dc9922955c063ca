/* SPDX-License-Identifier: MIT */
/*
 * The hidden property "identity" of families whose code does not decide which chip it is: the
 * chip's name by its behaviour, with what is odd about it ("DS18B20 clone, family B1"), or
 * "unknown".
 */
#pragma once

#include "hal/chips/property.h"

/* A row of a family's table; the function of the way ends with property_text(). */
#define IDENTITY_ROW(way, ...) \
	PROPERTY("identity", ASCII, STABLE, READ, .size = 48, .hidden = true, .how = (way), \
	         __VA_ARGS__)
