/* SPDX-License-Identifier: MIT */
/* /statistics, and how requests are counted for it. */
#pragma once

#include "hal/native/state.h"

/* A request was taken; it is answered. */
void tally_begin(struct native *native, struct job *job);
void tally_end(struct native *native, struct job *job, const struct bus_answer *answer);

extern const struct family virtual_statistics;
