/* SPDX-License-Identifier: MIT */
/* The engine's thread: what it does in turn, the bell that wakes it, the counters it publishes. */
#include <errno.h>
#include <sched.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

#include "hal/bus/worker.h"
#include "src/daemon/engine/command/controllers.h"
#include "src/daemon/host/engine_thread.h"
#include "src/daemon/host/last.h"
#include "src/daemon/host/private.h"
#include "src/daemon/serve/serve.h"
#include "src/memory/control/control.h"
#include "src/public/ows.h"

#define ENGINE_STACK (128 * 1024)
enum {
	COUNTER_LOG_DROPPED,    /* lost lines of the log */
	COUNTER_MUTED_BELLS,    /* bells rung without end, left out for a while */
	COUNTER_WORKER_STALLS,  /* messages of buses that had to wait */
	COUNTER_DROPPED_EVENTS, /* dropped events of buses */
	COUNTER_UNFINISHED,     /* 1 or 2: a reload is not whole yet */
	COUNTER_UNSTORED,       /* commands of Start "last" that could not be stored */
	COUNTER_REFUSED,        /* reloads that were refused */
	HOST_COUNTERS,
};
static const char *const host_counters[HOST_COUNTERS] = {
	[COUNTER_LOG_DROPPED] = "log_dropped",      [COUNTER_MUTED_BELLS] = "muted_bells",
	[COUNTER_WORKER_STALLS] = "worker_stalls",  [COUNTER_DROPPED_EVENTS] = "dropped_events",
	[COUNTER_UNFINISHED] = "unfinished_reload", [COUNTER_UNSTORED] = "failed_stores",
	[COUNTER_REFUSED] = "refused_reloads",
};

void host_ring(void *ctx)
{
	struct host *h = ctx;

	bells_ring(&h->bells);
}

/* True: there may be more. */
static bool take_messages(struct serving *now, int64_t now_ns)
{
	const struct worker_message *message;
	bool more = false;

	for (unsigned i = 0; i < now->worker_count; i++) {
		unsigned n = 0;

		/* bounded: a bus that sends without end does not keep the other buses waiting */
		while (n < 2 * BUS_MAX_DEPTH && (message = worker_next(now->workers[i])) != NULL) {
			n++;
			if (message->is_event)
				engine_event(now->engine, i, &message->event, now_ns);
			else
				engine_answer(now->engine, i, &message->answer, now_ns);
		}
		more |= n == 2 * BUS_MAX_DEPTH;
	}
	return more;
}

static uint32_t publish_list(struct host *h, const struct bus_counter *c, size_t n, uint32_t index)
{
	for (size_t i = 0; i < n; i++)
		image_counter(&h->now->memory.image, index++, bus_counted(&c[i]));
	return index;
}

static void publish_counters(struct host *h)
{
	struct image *image = &h->now->memory.image;
	uint32_t index = h->now->own_counters;
	struct serving_counts lost = serving_counts(h->now);
	const struct bus_counter *list;
	size_t n;

	serving_publish(h->now);
	image_counter(image, index + COUNTER_LOG_DROPPED, log_dropped(h->log));
	image_counter(image, index + COUNTER_MUTED_BELLS, h->bells.mutes);
	image_counter(image, index + COUNTER_WORKER_STALLS, lost.stalls);
	image_counter(image, index + COUNTER_DROPPED_EVENTS, lost.dropped);
	image_counter(image, index + COUNTER_UNFINISHED,
	              __atomic_load_n(&h->unfinished, __ATOMIC_RELAXED));
	image_counter(image, index + COUNTER_UNSTORED, lost.unstored);
	image_counter(image, index + COUNTER_REFUSED,
	              __atomic_load_n(&h->refused_reloads, __ATOMIC_RELAXED));
	list = control_counters(h->control, &n);
	index = publish_list(h, list, n, index + HOST_COUNTERS);
	if (!h->serve)
		return;
	list = serve_counters(h->serve, &n);
	publish_list(h, list, n, index);
}

/* --- Controllers ------------------------------------------------------------------------------ */

/* Programs that connect and hang up without end do not keep the engine from its work. */
#define MESSAGES_AT_ONCE (2 * OWS_CONTROLLERS)

/* Those that have connected, and those that hung up or are dead. True: there may be more. */
static bool take_controllers(struct host *h, int64_t now_ns)
{
	struct control_message message;

	for (unsigned n = 0; n < MESSAGES_AT_ONCE; n++) {
		if (!control_next(h->control, &message))
			return false;
		if (message.joins) {
			bells_add(&h->bells, message.seat, message.bell);
			engine_controller_join(h->now->engine, message.seat, &message.controller,
			                       now_ns);
		} else {
			bells_remove(&h->bells, message.seat);
			engine_controller_left(h->now->engine, message.seat, now_ns);
		}
		control_done(h->control, &message);
	}
	return true;
}

/* All that have joined the engine before join the next, with their new memories. */
static void hand_over_controllers(struct host *h, struct engine *next, int64_t now_ns)
{
	struct control_message message;
	unsigned seat = 0;

	take_controllers(h, now_ns);
	while (control_prepared(h->control, &seat, &message))
		engine_controller_join(next, message.seat, &message.controller, now_ns);
}

/* --- The thread ------------------------------------------------------------------------------- */

/* Take over what a reload has made, and let go of the engine that it has ended. */
static void take_next(struct host *h, int64_t now_ns)
{
	struct serving *next = __atomic_load_n(&h->next, __ATOMIC_ACQUIRE);
	struct engine *ended = __atomic_load_n(&h->ended, __ATOMIC_ACQUIRE);

	if (next) {
		hand_over_controllers(h, next->engine, now_ns);
		engine_adopt(next->engine, h->now->engine, h->plan, now_ns);
		serving_keep_counts(next, h->now, h->plan);
		image_awake(&next->memory.image, true);
		__atomic_store_n(&h->now, next, __ATOMIC_RELEASE);
		publish_counters(h); /* before anybody sees the image: no total falls */
		__atomic_store_n(&h->next, NULL, __ATOMIC_RELEASE);
	}
	if (ended) {
		engine_abandon(ended);
		__atomic_store_n(&h->ended, NULL, __ATOMIC_RELEASE);
	}
}

/* A ring or a mark after the words are cleared wakes the thread. */
static void sleep_until(struct host *h, int64_t until_ns)
{
	struct image *image = &h->now->memory.image;
	bool rung;

	image_awake(image, false);
	rung = bells_close_eyes(&h->bells);
	if (!rung && !engine_controllers_marked(h->now->engine))
		bells_sleep(&h->bells, until_ns);
	image_awake(image, true);
	bells_open_eyes(&h->bells);
}

static void announce(struct host *h)
{
	struct image *image = &h->now->memory.image;

	image_news(image);
	control_news(h->control, &image->header->news);
}

static void *engine_main(void *ctx)
{
	struct host *h = ctx;
	int64_t counted_ns = 0;

	for (;;) {
		int64_t now_ns = ows_now(), next_ns;
		bool more;

		/* read the bell first, then look for what it announced */
		bells_look(&h->bells);
		if (__atomic_load_n(&h->stop, __ATOMIC_ACQUIRE))
			break;
		more = take_messages(h->now, now_ns);
		more |= take_controllers(h, now_ns);
		next_ns = engine_step(h->now->engine, now_ns);
		if (now_ns - counted_ns >= h->now->config->period_ns) {
			counted_ns = now_ns;
			publish_counters(h);
		}
		if (engine_published(h->now->engine))
			announce(h);
		if (__atomic_load_n(&h->next, __ATOMIC_ACQUIRE) ||
		    __atomic_load_n(&h->ended, __ATOMIC_ACQUIRE))
			take_next(h, now_ns);
		else if (!more) /* no bell rings for what is left */
			sleep_until(h, next_ns);
	}
	/* a set that was in time is remembered for the owsd after this one */
	control_end(h->control);
	engine_step(h->now->engine, ows_now());
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
	sigfillset(&all);
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
	const struct bus_counter *serve = NULL, *control;
	struct image_counter *plan;
	size_t n = 0, controls;

	control = control_counters(h->control, &controls);
	if (h->serve)
		serve = serve_counters(h->serve, &n);
	plan = calloc(HOST_COUNTERS + controls + n, sizeof(*plan));
	*count = 0;
	if (!plan)
		return NULL;
	for (unsigned i = 0; i < HOST_COUNTERS; i++)
		plan[(*count)++] = (struct image_counter){host_counters[i], UINT32_MAX};
	for (size_t i = 0; i < controls; i++)
		plan[(*count)++] = (struct image_counter){control[i].name, UINT32_MAX};
	for (size_t i = 0; i < n; i++)
		plan[(*count)++] = (struct image_counter){serve[i].name, UINT32_MAX};
	return plan;
}
