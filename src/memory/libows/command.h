/* SPDX-License-Identifier: MIT */
/* What all that commands has in common: may it, does owsd live, and the bell. */
#pragma once

#include <stdint.h>

struct ows;

/*
 * Does owsd let this handle command the record? Returns 0, -EACCES, or -ESTALE: owsd looks at this
 * memory no more.
 */
int command_allowed(const struct ows *h, uint32_t record);
/*
 * Is anything that is set now taken? Returns 0; -EACCES: the handle is OWS_READ; -EPERM: it belongs
 * to the process that this one was forked from; -ESTALE: owsd has ended, has another memory for
 * this handle, or its heart stands still. No system call.
 */
int command_ready(struct ows *h);
/*
 * Wake the engine unless it is awake, after something was marked. Returns 0, or -ESTALE if owsd no
 * longer looked at this memory. At most one system call.
 */
int command_ring(struct ows *h);
