/* SPDX-License-Identifier: MIT */
/* How `owsctl watch` sleeps between two looks, and follows owsd over restarts. */
#include <errno.h>
#include <time.h>

#include "hal/base/time.h"
#include "src/tool/owsctl/ctl.h"
#include "src/tool/owsctl/watch/terminal.h"
#include "src/tool/owsctl/watch/watch_sleep.h"

#define BETWEEN_LOOKS (10 * NS_PER_MS) /* changes may come faster than a person reads them */

static const struct watch_event restarted = {"restarted", "was started again"};
static const struct watch_event reloaded = {"reloaded", "has reloaded its file"};
static const struct watch_event back = {"back", "is back"};
const struct watch_event watch_lost = {"lost", ""};

bool watch_over(const struct watch *watch)
{
	return terminal_asked_to_end() || watch->left == 0 || ows_now() >= watch->end_ns;
}

const struct watch_event *watch_collect(struct watch *watch, const struct ows_daemon *daemon)
{
	bool went_on = daemon->start_ns == watch->start_ns;

	watch->start_ns = daemon->start_ns;
	watch->generation = daemon->generation;
	watch->alive = daemon->alive;
	rows_free(&watch->rows);
	rows_collect(watch->h, watch->patterns, watch->pattern_count, watch->driver, &watch->rows);
	return went_on ? &reloaded : &restarted;
}

const struct watch_event *watch_sleep(struct watch *watch, int64_t timeout_ns)
{
	const struct timespec pause = {.tv_nsec = BETWEEN_LOOKS};
	int64_t left = watch->end_ns - ows_now();
	struct ows_daemon daemon;
	int err;

	if (left > 0)
		ctl_sleep(watch->h, &watch->news, timeout_ns < left ? timeout_ns : left);
	nanosleep(&pause, NULL);
	err = ows_daemon(watch->h, ows_now(), &daemon);
	if (err && err != -ESTALE)
		return NULL;
	if (daemon.generation != watch->generation)
		return watch_collect(watch, &daemon);
	if ((bool)daemon.alive == watch->alive)
		return NULL;
	watch->alive = daemon.alive;
	return daemon.alive ? &back : &watch_lost;
}
