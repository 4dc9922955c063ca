/* SPDX-License-Identifier: MIT */
/* Waits for news: ows_wait(). */
#include <errno.h>

#include "src/memory/libows/alive.h"
#include "src/memory/libows/handle.h"
#include "src/memory/libows/news.h"

int ows_wait(struct ows *h, uint32_t *news, int64_t timeout_ns)
{
	const uint32_t *word = &h->map.image->news;
	int64_t now_ns = ows_now(), until = wait_until(now_ns, timeout_ns);

	for (;; now_ns = ows_now()) {
		int64_t left = ALIVE_LOOK_NS; /* no owsd wakes a program that waits on an orphan */
		uint32_t seen;
		int err;

		seen = __atomic_load_n(word, __ATOMIC_ACQUIRE);
		if (alive_look(h, now_ns))
			return news_stale(h, timeout_ns);
		if (seen != *news) {
			*news = seen;
			return 1;
		}
		if (until <= now_ns)
			return 0;
		if (until - now_ns < left)
			left = until - now_ns;
		err = news_sleep(h, seen, left);
		if (err && err != -ETIMEDOUT)
			return err;
	}
}
