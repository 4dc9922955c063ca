/* SPDX-License-Identifier: MIT */
#include "handle.h"

#include <errno.h>

int ows_wait(struct ows *h, uint32_t *news, int64_t timeout_ns)
{
	const uint32_t *word = &h->map.image->news;
	int64_t now_ns = ows_now();
	int64_t until = timeout_ns < 0 || timeout_ns > INT64_MAX - now_ns ? -1 : now_ns + timeout_ns;

	for (;;) {
		uint32_t seen = __atomic_load_n(word, __ATOMIC_ACQUIRE);
		int64_t left = -1;
		int err;

		if (handle_state(h))
			return -ESTALE;
		if (seen != *news) {
			*news = seen;
			return 1;
		}
		if (until >= 0) {
			left = until - ows_now();
			if (left <= 0)
				return 0;
		}
		err = segment_wait(word, seen, left);
		if (err && err != -ETIMEDOUT)
			return err;
	}
}
