/* SPDX-License-Identifier: MIT */
/*
 * Scheme "replay": the native bus, or that of owserver, on a recording. Its links, its connection
 * or its I2C adapter answer as recorded; what is above them is owsd's own.
 */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/base/time.h"
#include "hal/ds2482/ds2482.h"
#include "hal/ds2482/master.h"
#include "hal/ds2482/power.h"
#include "hal/native/native.h"
#include "hal/sim/replay.h"
#include "hal/trace/trace.h"

/* Stands in place of the operations of the bus, whose copy it has. */
struct replay {
	struct bus_ops ops; /* first */
	const struct bus_ops *inner;
	struct bus_env env; /* with the tap */
	const struct bus_env *host;
	bool execs; /* exec is at work */
	int64_t now_ns, due_ns;
	struct trace *trace;
	char name[];
};

/*
 * --- The time of a replay ---
 *
 * It goes on in recorded calls and in waits, until their time is over, and to the next step: that
 * begins when it was due, or, if it is called for something else, sooner. So what a driver measures
 * is what it measured then, however late the machine is now. What is simple waits outside its step,
 * too: there its time is the host's.
 */

static int64_t replay_now(void *ctx)
{
	struct replay *replay = ctx;

	return replay->ops.exec && !replay->execs ? bus_now(replay->host) : replay->now_ns;
}

static int replay_wait(void *ctx, int fd, short events, int64_t until_ns)
{
	struct replay *replay = ctx;
	int ready = replay->host->wait(replay->host->ctx, fd, events, until_ns);

	if (!ready && until_ns > replay->now_ns)
		replay->now_ns = until_ns;
	return ready;
}

static struct replay *replay_of(struct bus *bus)
{
	return (struct replay *)(uintptr_t)bus->ops;
}

static int64_t replay_step(struct bus *bus, int64_t now)
{
	struct replay *replay = replay_of(bus);

	replay->now_ns = later_ns(replay->now_ns, earlier_ns(now, replay->due_ns));
	replay->due_ns = replay->inner->step(bus, replay->now_ns);
	return replay->due_ns;
}

static void replay_exec(struct bus *bus, struct bus_req *req, struct bus_answer *answer)
{
	struct replay *replay = replay_of(bus);

	replay->now_ns = bus_now(replay->host);
	replay->execs = true;
	replay->inner->exec(bus, req, answer);
	replay->execs = false;
}

static void give_answer(void *ctx, const struct bus_answer *answer)
{
	const struct bus_env *host = ((struct replay *)ctx)->host;

	host->answer(host->ctx, answer);
}

static void give_event(void *ctx, const struct bus_event *event)
{
	const struct bus_env *host = ((struct replay *)ctx)->host;

	host->event(host->ctx, event);
}

/* --- Links --- */

struct replay_master {
	struct link_master master; /* first */
	struct link none;          /* in place of which the trace gives its links */
};

static int open_replay(struct link_master *master, char *why, size_t why_size)
{
	(void)master, (void)why, (void)why_size;
	return 0;
}

static void close_replay(struct link_master *master)
{
	(void)master;
}

static unsigned replay_channels(struct link_master *master)
{
	return trace_links((struct trace *)master->env->tap);
}

static struct link *replay_channel(struct link_master *master, unsigned n)
{
	(void)n;
	return &((struct replay_master *)master)->none;
}

static void destroy_master(struct link_master *master)
{
	free(master);
}

static int create_master(const char *where, const struct bus_env *env, struct link_master **master,
                         char *why, size_t why_size);

static const struct link_master_ops replay_master = {
	.create = create_master,
	.open = open_replay,
	.close = close_replay,
	.channels = replay_channels,
	.channel = replay_channel,
	.destroy = destroy_master,
	.simulated = true,
};

static int create_master(const char *where, const struct bus_env *env, struct link_master **master,
                         char *why, size_t why_size)
{
	struct replay_master *replay = calloc(1, sizeof(*replay));

	(void)where, (void)why, (void)why_size;
	if (!replay)
		return -ENOMEM;
	replay->master = (struct link_master){.ops = &replay_master, .env = env};
	replay->none.env = env;
	*master = &replay->master;
	return 0;
}

static void replay_destroy(struct bus *bus)
{
	struct replay *replay = replay_of(bus);

	replay->inner->destroy(bus);
	trace_end(replay->trace);
	free(replay);
}

/* --- The driver of the DS2482, on recorded transactions --- */

/* The trace gives one in place of it. */
static int open_adapter(void *ctx, const struct bus_env *env, struct i2c_adapter **adapter,
                        char *why, size_t why_size)
{
	(void)ctx, (void)env, (void)why, (void)why_size;
	*adapter = NULL;
	return 0;
}

static void destroy_source(void *ctx)
{
	(void)ctx;
}

static int create_ds2482(const char *where, const struct bus_env *env, struct link_master **master,
                         char *why, size_t why_size);

static const struct link_master_ops replay_ds2482 = {
	.create = create_ds2482,
	.option = ds2482_option,
	.open = ds2482_open,
	.grow = ds2482_grow,
	.close = ds2482_close,
	.channels = ds2482_channels,
	.channel = ds2482_channel,
	.cost = ds2482_cost,
	.destroy = ds2482_destroy,
	.simulated = true,
};

static int create_ds2482(const char *where, const struct bus_env *env, struct link_master **master,
                         char *why, size_t why_size)
{
	const struct ds2482_source source = {
		.open = open_adapter, .destroy = destroy_source, .name = where};

	return ds2482_create(&replay_ds2482, env, &source, "", master, why, why_size);
}

static int create_on(struct replay *replay, struct bus **bus, char *why, size_t why_size)
{
	bool links = trace_links(replay->trace);

	if (links || trace_has(replay->trace, TRACE_ADAPTER))
		return native_create(&replay_bus, links ? &replay_master : &replay_ds2482,
		                     replay->name, &replay->env, bus, why, why_size);
	if (!trace_has(replay->trace, TRACE_SERVER)) {
		snprintf(why, why_size, "%.100s has no line of a wire or a server", replay->name);
		return -EINVAL;
	}
	return owserver_bus.create("", &replay->env, bus, why, why_size);
}

static int replay_create(const char *where, const struct bus_env *env, struct bus **bus, char *why,
                         size_t why_size)
{
	struct replay *replay = calloc(1, sizeof(*replay) + strlen(where) + 1);
	int err;

	if (!replay)
		return -ENOMEM;
	memcpy(replay->name, where, strlen(where) + 1);
	err = trace_replay(&replay->trace, replay->name, why, why_size);
	if (err) {
		free(replay);
		return err == -ENOMEM ? err : -EINVAL;
	}
	replay->host = env;
	replay->now_ns = bus_now(env);
	replay->due_ns = INT64_MAX;
	replay->env = (struct bus_env){.ctx = replay,
	                               .now = replay_now,
	                               .wait = replay_wait,
	                               .answer = give_answer,
	                               .event = give_event,
	                               .tap = &replay->trace->tap};
	err = create_on(replay, bus, why, why_size);
	if (err) {
		trace_end(replay->trace);
		free(replay);
		return err == -ENOMEM ? err : -EINVAL;
	}
	replay->inner = (*bus)->ops;
	replay->ops = *replay->inner;
	replay->ops.destroy = replay_destroy;
	replay->ops.step = replay_step;
	replay->ops.exec = replay->ops.exec ? replay_exec : NULL;
	replay->ops.testing = true;
	(*bus)->ops = &replay->ops;
	return 0;
}

const struct bus_ops replay_bus = {
	.scheme = "replay",
	.summary = "what owsctl record has recorded, in place of a wire",
	.create = replay_create,
	.caches = "",
	NATIVE_BUS_SLOTS,
	.testing = true,
};
