/* SPDX-License-Identifier: MIT */
/* What the first conversions (first.h) are to devices that are found later. */
#pragma once

#include "hal/native/state.h"

/* The longest conversion, of a chip whose resolution is not known. */
#define FIRST_LONGEST_NS (750 * TXN_MS)

/* A device was found on a channel: it converts with the others, if it is a thermometer. */
void first_found(struct native *native, struct device *device);
/* Did it convert with all others of its wire, while the search went on? */
bool first_took_part(const struct native *native, const struct device *device);
/* The conversions of all channels are void: their wires had no supply. */
void first_void(struct native *native);
