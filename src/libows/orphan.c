/* SPDX-License-Identifier: MIT */
/* Checks now and then whether the image is an orphan, for callers that need no heartbeat. */
#include "src/libows/orphan.h"
#include "src/libows/alive.h"

int handle_orphan(struct ows *h, int64_t now_ns)
{
	if (now_ns < h->alive_now || handle_age(now_ns, h->alive_now) >= ORPHAN_LOOK_NS)
		handle_alive(h, now_ns);
	return h->orphan ? -ESTALE : 0;
}
