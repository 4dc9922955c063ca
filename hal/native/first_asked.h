/* SPDX-License-Identifier: MIT */
/* What the first conversions (first.h) are to requests and to devices that are found later. */
#pragma once

#include "hal/native/state.h"

/*
 * Does a request that was not looked at ask for the temperature of a device that its id names?
 * *path is what it means.
 */
bool first_names(const struct native *native, const struct job *job, struct path *path);
/* Does a request name by its id alone a device that is no thermometer? */
bool first_asks(const struct native *native, const struct job *job);
/* Does an alarm or an output wait for the end of the search? Then no input goes before that. */
bool first_hurries(const struct native *native);
/* A wire that was not searched yet, and on which all can be told to convert. */
bool first_fits(const struct native *native, unsigned n);

/* The longest conversion, of a chip whose resolution is not known. */
#define FIRST_LONGEST_NS (750 * TXN_MS)

/* A device was found on a channel: it converts with the others, if it is a thermometer. */
void first_found(struct native *native, struct device *device);
/* Did it convert with all others of its wire, while the search went on? */
bool first_took_part(const struct native *native, const struct device *device);
/* The conversions of all channels are void: their wires had no supply. */
void first_void(struct native *native);
