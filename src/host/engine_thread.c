/* SPDX-License-Identifier: MIT */
/* The engine's thread: what it does in turn, the bell that wakes it, the counters it publishes. */
#include <errno.h>
#include <limits.h>
#include <sched.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

#include "hal/bus/time.h"
#include "hal/bus/worker.h"
#include "src/host/engine_thread.h"
#include "src/host/private.h"
#include "src/libows/ows.h"
#include "src/serve/serve.h"
#include "src/shm/futex.h"

#define ENGINE_STACK (128 * 1024)
/* After so many turns without news the engine pauses: a bell rung without end must not spin it. */
#define IDLE_RINGS 3
#define IDLE_NS NS_PER_MS

enum {
	COUNTER_LOG_DROPPED,
	COUNTER_IDLE_RINGS,
	COUNTER_REPAIRED,
	COUNTER_WORKER_STALLS,
	COUNTER_DROPPED_EVENTS,
	COUNTER_UNFINISHED,
	HOST_COUNTERS,
};
static const char *const host_counters[HOST_COUNTERS] = {
	[COUNTER_LOG_DROPPED] = "log_dropped",         [COUNTER_IDLE_RINGS] = "idle_rings",
	[COUNTER_REPAIRED] = "mended_command_headers", [COUNTER_WORKER_STALLS] = "worker_stalls",
	[COUNTER_DROPPED_EVENTS] = "dropped_events",   [COUNTER_UNFINISHED] = "unfinished_reload",
};

void host_ring(void *ctx)
{
	struct host *h = ctx;
	uint32_t *bell;

	__atomic_fetch_add(&h->ringing, 1, __ATOMIC_SEQ_CST);
	bell = __atomic_load_n(&h->bell, __ATOMIC_SEQ_CST);
	if (bell) {
		__atomic_fetch_add(bell, 1, __ATOMIC_SEQ_CST);
		segment_wake(bell, 1);
	}
	__atomic_fetch_sub(&h->ringing, 1, __ATOMIC_SEQ_CST);
}

void host_wait_for_ringers(const struct host *h)
{
	static const uint32_t nobody = 0;

	while (__atomic_load_n(&h->ringing, __ATOMIC_SEQ_CST))
		segment_wait(&nobody, 0, HOST_LOOK_NS);
}

static bool take_messages(struct serving *now, int64_t now_ns)
{
	struct worker_message message;
	bool any = false;

	for (unsigned i = 0; i < now->worker_count; i++) {
		/*
		 * bounded, so that a bus that sends without end does not keep the other buses
		 * waiting
		 */
		for (unsigned n = 0; n < 2 * BUS_MAX_DEPTH; n++) {
			if (!worker_next(now->workers[i], &message))
				break;
			any = true;
			if (message.is_event)
				engine_event(now->engine, i, &message.event, now_ns);
			else
				engine_answer(now->engine, i, &message.answer, now_ns);
		}
	}
	return any;
}

static void publish_serve_counters(struct host *h, uint32_t index)
{
	size_t n;
	const struct bus_counter *c = serve_counters(h->serve, &n);

	for (size_t i = 0; i < n; i++)
		image_counter(&h->now->memory.image, index++, bus_counted(&c[i]));
}

static void publish_counters(struct host *h)
{
	struct image *image = &h->now->memory.image;
	uint32_t index = h->now->own_counters;

	serving_publish(h->now);
	image_counter(image, index + COUNTER_LOG_DROPPED, log_dropped(h->log));
	image_counter(image, index + COUNTER_IDLE_RINGS, h->idle_rings);
	image_counter(image, index + COUNTER_REPAIRED, h->mended);
	image_counter(image, index + COUNTER_WORKER_STALLS, serving_stalls(h->now));
	image_counter(image, index + COUNTER_DROPPED_EVENTS, serving_dropped(h->now));
	image_counter(image, index + COUNTER_UNFINISHED,
	              __atomic_load_n(&h->unfinished, __ATOMIC_RELAXED));
	if (h->serve)
		publish_serve_counters(h, index + HOST_COUNTERS);
}

/*
 * Use the command segment that the supervisor has made again. The bell changes first: a program
 * that still rings the old bell is noticed at the next period.
 */
static void take_renewed(struct host *h, int64_t now_ns)
{
	struct commands *renewed = __atomic_load_n(&h->renewed, __ATOMIC_ACQUIRE);

	if (!renewed)
		return;
	__atomic_store_n(&h->bell, commands_bell(renewed), __ATOMIC_RELEASE);
	h->now->commands = renewed;
	engine_take_commands(h->now->engine, renewed, now_ns);
	__atomic_store_n(&h->renewed, NULL, __ATOMIC_RELEASE);
}

/* Take over what a reload has made, and let go of the engine that it has ended. */
static void take_next(struct host *h, int64_t now_ns)
{
	struct serving *next = __atomic_load_n(&h->next, __ATOMIC_ACQUIRE);
	struct engine *ended = __atomic_load_n(&h->ended, __ATOMIC_ACQUIRE);

	if (next) {
		engine_adopt(next->engine, h->now->engine, h->plan, now_ns);
		serving_keep_counts(next, h->now, h->plan->ports);
		__atomic_store_n(&h->bell, commands_bell(next->commands), __ATOMIC_SEQ_CST);
		__atomic_store_n(&h->now, next, __ATOMIC_RELEASE);
		__atomic_store_n(&h->next, NULL, __ATOMIC_RELEASE);
	}
	if (ended) {
		engine_abandon(ended);
		__atomic_store_n(&h->ended, NULL, __ATOMIC_RELEASE);
	}
}

static void sleep_until(struct host *h, uint32_t seen, int64_t until_ns)
{
	int64_t now_ns = ows_now();

	if (until_ns <= now_ns)
		return;
	commands_awake(h->now->commands, false);
	segment_wait(h->bell, seen, until_ns - now_ns);
	commands_awake(h->now->commands, true);
}

static void *engine_main(void *ctx)
{
	struct host *h = ctx;
	int64_t counted_ns = 0;
	unsigned idle = 0;

	while (!__atomic_load_n(&h->stop, __ATOMIC_ACQUIRE)) {
		uint32_t *bell = h->bell, seen = __atomic_load_n(bell, __ATOMIC_ACQUIRE);
		int64_t now_ns = ows_now(), next_ns;
		bool busy = take_messages(h->now, now_ns);

		next_ns = engine_step(h->now->engine, now_ns);
		if (now_ns - counted_ns >= h->now->config->period_ns) {
			counted_ns = now_ns;
			h->mended += commands_repair(h->now->commands, false);
			publish_counters(h);
			busy = true;
		}
		if (engine_published(h->now->engine)) {
			busy = true;
			image_news(&h->now->memory.image);
			segment_wake(&h->now->memory.image.header->news, INT_MAX);
		}
		take_renewed(h, now_ns);
		take_next(h, now_ns);
		if (bell != h->bell) /* seen was read from the bell before: read the new one */
			continue;
		idle = busy ? 0 : idle + 1;
		if (idle > IDLE_RINGS) {
			static const uint32_t nobody = 0;

			h->idle_rings++;
			segment_wait(&nobody, 0, IDLE_NS);
		}
		sleep_until(h, seen, next_ns);
	}
	return NULL;
}

int host_start_engine(struct host *h, int rt_priority, char *why, size_t why_size)
{
	struct sched_param param = {.sched_priority = rt_priority};
	pthread_attr_t attr;
	sigset_t all, before;
	int err;

	pthread_attr_init(&attr);
	pthread_attr_setstacksize(&attr, ENGINE_STACK);
	if (rt_priority) {
		pthread_attr_setinheritsched(&attr, PTHREAD_EXPLICIT_SCHED);
		pthread_attr_setschedpolicy(&attr, SCHED_FIFO);
		pthread_attr_setschedparam(&attr, &param);
		if (mlockall(MCL_CURRENT | MCL_FUTURE))
			log_warning(h->log, "--rt: memory cannot be locked: %s", strerror(errno));
	}
	/* a synchronous SIGBUS belongs to the guard and cannot be blocked */
	sigfillset(&all);
	sigdelset(&all, SIGBUS);
	pthread_sigmask(SIG_SETMASK, &all, &before);
	err = pthread_create(&h->thread, &attr, engine_main, h);
	pthread_sigmask(SIG_SETMASK, &before, NULL);
	pthread_attr_destroy(&attr);
	if (err) {
		snprintf(why, why_size, "cannot start the engine's thread: %s%s", strerror(err),
		         err == EPERM && rt_priority
		                 ? " (--rt needs CAP_SYS_NICE or a limit RLIMIT_RTPRIO)"
		                 : "");
		return -err;
	}
	h->running = true;
	pthread_setname_np(h->thread, "owsd-engine");
	return 0;
}

struct image_counter *host_plan_counters(const struct host *h, uint32_t *count)
{
	const struct bus_counter *serve = NULL;
	struct image_counter *plan;
	size_t n = 0;

	if (h->serve)
		serve = serve_counters(h->serve, &n);
	plan = calloc(HOST_COUNTERS + n, sizeof(*plan));
	*count = 0;
	if (!plan)
		return NULL;
	for (unsigned i = 0; i < HOST_COUNTERS; i++)
		plan[(*count)++] = (struct image_counter){host_counters[i], UINT32_MAX};
	for (size_t i = 0; i < n; i++)
		plan[(*count)++] = (struct image_counter){serve[i].name, UINT32_MAX};
	return plan;
}
