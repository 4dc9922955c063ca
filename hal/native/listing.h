/* SPDX-License-Identifier: MIT */
/* Directories. */
#pragma once

#include "hal/native/state.h"

/* A whole answer that needs no wire. 0 or the error. */
int listing(struct native *native, struct job *job);
/* One more device in an answer. */
int listing_add_device(struct native *native, struct job *job, const struct device *device);
/* What stands in / and /bus.N beside the devices. */
int listing_add_rest(struct native *native, struct job *job);
