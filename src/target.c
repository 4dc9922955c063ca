/* SPDX-License-Identifier: MIT */
#include "target.h"

#include "hal/bus.h"
#include "libows/ows.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

static int64_t now(void *ctx)
{
	(void)ctx;
	return ows_now();
}

static int no_wait(void *ctx, int fd, short events, int64_t until_ns)
{
	(void)ctx, (void)fd, (void)events, (void)until_ns;
	return -ECANCELED;
}

static void no_answer(void *ctx, const struct bus_answer *answer)
{
	(void)ctx, (void)answer;
}

static void no_event(void *ctx, const struct bus_event *event)
{
	(void)ctx, (void)event;
}

int target_check(const char *target, char *why, size_t why_size)
{
	static const struct bus_env env = {
		.now = now, .wait = no_wait, .answer = no_answer, .event = no_event
	};
	struct bus *bus = NULL;
	int err = bus_create(target, &env, &bus, why, why_size);

	if (err && !*why)
		snprintf(why, why_size, "%s", strerror(-err));
	if (!err)
		bus_destroy(bus);
	return err;
}
