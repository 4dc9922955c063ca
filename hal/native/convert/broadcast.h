/* SPDX-License-Identifier: MIT */
/*
 * Convert T for all thermometers of a channel, and what follows for a chip that was told to
 * convert. All times are ns. The thread of the bus calls it; a broadcast takes some ms.
 */
#pragma once

#include "hal/native/state.h"

/*
 * Convert T to all; -EBADMSG if no chip begins. strong: with the pull-up, which holds the channel
 * for longest ns. The requests that are due wait for the end then.
 */
int broadcast_convert(struct native *native, unsigned n, bool strong, int64_t longest);
/*
 * This chip alone began to convert at now. shown: and has shown it. All that wait for it wait for
 * that.
 */
void broadcast_started(struct native *native, struct device *device, int64_t now, bool shown);
/* It was told to convert, at now at the latest, and whether it heard is not known. */
void broadcast_told(const struct native *native, struct device *device, int64_t now);

/* A write to /simultaneous: all chips of a kind on one channel or on all convert. */
void convert_all(struct native *native, struct job *job);
