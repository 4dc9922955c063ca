/* SPDX-License-Identifier: MIT */
/* The transactions of a job. */
#pragma once

#include "hal/native/state.h"

/* Make the txn ready for the next element, from its beginning. */
void job_txn(struct native *native, struct job *job);
/* All elements of an array, and they come one by one. */
bool job_wants_all(const struct job *job);
/* How long a value of the property is true enough for a request that takes a cached one. */
int64_t property_life_ns(const struct native *native, const struct property *property);
