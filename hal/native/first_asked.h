/* SPDX-License-Identifier: MIT */
/* Which requests are served before the first search of all wires has ended (first.h). */
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
