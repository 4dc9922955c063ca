/* SPDX-License-Identifier: MIT */
/* Checks now and then whether the image is an orphan, for callers that need no heartbeat. */
#ifndef LIBOWS_ORPHAN_H
#define LIBOWS_ORPHAN_H

#include <stdint.h>

struct ows;

/* Checks the heartbeat once a second. Returns 0, or -ESTALE on an orphan. */
int handle_orphan(struct ows *h, int64_t now_ns);

#endif
