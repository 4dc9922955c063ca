/* SPDX-License-Identifier: MIT */
/* How `owsctl watch` sleeps between two looks, and follows owsd over restarts. */
#include <errno.h>
#include <stdlib.h>
#include <time.h>

#include "hal/base/time.h"
#include "src/tool/owsctl/ctl.h"
#include "src/tool/owsctl/watch/terminal.h"
#include "src/tool/owsctl/watch/watch_sleep.h"

#define LONGEST_SLEEP (500 * NS_PER_MS) /* an age sends no wake-up, nor does a closed pipe */

bool watch_over(const struct watch *watch)
{
	return terminal_asked_to_end() || watch->left == 0 || ows_now() >= watch->end_ns;
}

enum watch_event watch_collect(struct watch *watch, const struct ows_daemon *daemon)
{
	bool went_on = daemon->start_ns == watch->start_ns;
	int count = ows_count(watch->h);

	watch->start_ns = daemon->start_ns;
	watch->generation = daemon->generation;
	watch->alive = daemon->alive;
	watch->changed_count = -1;
	watch->news++;
	watch_free(watch);
	watch->row_of = ctl_need(malloc(((size_t)count + 1) * sizeof(*watch->row_of)));
	rows_collect(watch->h, watch->patterns, watch->pattern_count, watch->driver, &watch->rows);
	for (int i = 0; i < count; i++)
		watch->row_of[i] = -1;
	for (int i = 0; i < watch->rows.count; i++)
		if (watch->rows.row[i].signal >= 0)
			watch->row_of[watch->rows.row[i].signal] = i;
	return went_on ? WATCH_RELOADED : WATCH_RESTARTED;
}

void watch_free(struct watch *watch)
{
	rows_free(&watch->rows);
	free(watch->row_of);
	watch->row_of = NULL;
}

/* Wait for changes, and look for a new owsd when the present one is gone. */
static void watch_sleep_follow(struct watch *watch, int64_t timeout_ns)
{
	int n = ows_changes(watch->h, &watch->cursor, watch->changed, WATCH_BATCH, timeout_ns);

	if (n == -ENOMEM)
		ctl_need(NULL);
	if (n == -ESTALE)
		ows_reopen(watch->h);
	if (n == -EINTR)
		n = 0;
	watch->changed_count = n < 0 ? -1 : n;
	watch->news += n != 0;
}

/* Changes may come faster than a person reads them. */
static void pause_until(int64_t until_ns)
{
	int64_t left = until_ns - ows_now();
	const struct timespec pause = {.tv_nsec = (long)(left % NS_PER_S)};

	if (left > 0)
		nanosleep(&pause, NULL);
}

enum watch_event watch_sleep(struct watch *watch, int64_t least_ns, int64_t timeout_ns)
{
	struct ows_daemon daemon;
	int64_t now = ows_now();
	int err;

	if (timeout_ns > LONGEST_SLEEP)
		timeout_ns = LONGEST_SLEEP;
	if (timeout_ns > watch->end_ns - now)
		timeout_ns = watch->end_ns - now;
	watch->changed_count = 0;
	if (timeout_ns > 0)
		watch_sleep_follow(watch, timeout_ns);
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
