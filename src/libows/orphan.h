/* SPDX-License-Identifier: MIT */
/* For callers that need no heartbeat: whether the image is an orphan, looked at now and then. */
#ifndef LIBOWS_ORPHAN_H
#define LIBOWS_ORPHAN_H

#include <stdint.h>

struct ows;

/* Looks for the heartbeat once a second. 0, or -ESTALE on an orphan. */
int handle_orphan(struct ows *h, int64_t now_ns);

#endif
