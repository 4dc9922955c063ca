/* SPDX-License-Identifier: MIT */
/* How `owsctl watch` sleeps between two looks, and follows owsd over restarts. */
#include <errno.h>
#include <time.h>

#include "hal/bus/time.h"
#include "src/owsctl/ctl.h"
#include "src/owsctl/terminal.h"
#include "src/owsctl/watch_sleep.h"

#define LONGEST_SLEEP (500 * NS_PER_MS) /* an age or a dead owsd sends no wake-up */

bool watch_over(const struct watch *watch)
{
	return terminal_asked_to_end() || watch->left == 0 || ows_now() >= watch->end_ns;
}

int watch_collect(struct watch *watch, const struct ows_daemon *daemon)
{
	watch->generation = daemon->generation;
	watch->alive = daemon->alive;
	watch->news = 0;
	rows_free(&watch->rows);
	if (rows_collect(watch->h, watch->patterns, watch->pattern_count, watch->driver,
	                 &watch->rows) != 0)
		return -ENOMEM;
	return WATCH_RESTARTED;
}

/* Changes may come faster than anybody reads them. */
static void pause_until(int64_t until_ns)
{
	int64_t left = until_ns - ows_now();
	const struct timespec pause = {.tv_nsec = (long)(left % NS_PER_S)};

	if (left > 0)
		nanosleep(&pause, NULL);
}

int watch_sleep(struct watch *watch, int64_t least_ns, int64_t timeout_ns)
{
	struct ows_daemon daemon;
	int64_t now = ows_now();
	int err;

	if (timeout_ns > LONGEST_SLEEP)
		timeout_ns = LONGEST_SLEEP;
	if (timeout_ns > watch->end_ns - now)
		timeout_ns = watch->end_ns - now;
	if (timeout_ns > 0)
		ctl_sleep(watch->h, &watch->news, timeout_ns);
	pause_until(now + least_ns);
	err = ows_daemon(watch->h, ows_now(), &daemon);
	if (err && err != -ESTALE)
		return WATCH_NOTHING;
	if (daemon.generation != watch->generation)
		return watch_collect(watch, &daemon);
	if ((bool)daemon.alive == watch->alive)
		return WATCH_NOTHING;
	watch->alive = daemon.alive;
	return daemon.alive ? WATCH_BACK : WATCH_LOST;
}
