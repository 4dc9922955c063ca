/* SPDX-License-Identifier: MIT */
#include "host.h"

#include "hal/worker.h"
#include "indicator.h"
#include "libows/ows.h"
#include "serve/serve.h"
#include "serving.h"
#include "shm/reader.h"

#include <errno.h>
#include <limits.h>
#include <pthread.h>
#include <sched.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

#define ENGINE_STACK (128 * 1024)
/* A bell rung without news must not spin the engine. */
#define IDLE_RINGS 3
#define IDLE_NS    1000000
/* A consumer that takes the command segment away again and again has one made once a second. */
#define TEND_NS    1000000000
/* How often the loss of the image is said. */
#define IMAGE_LOST_NS 60000000000LL

/* How long the supervisor looks whether the engine, the server have taken what it gave them. */
#define LOOK_NS 1000000
/* How long a bus that a reload ends may take. */
#define END_NS 2000000000LL

struct host {
	struct serving *now; /* the engine's thread exchanges it, the supervisor alone else */
	struct serving *next; /* of a reload, for the engine to take over */
	const struct adoption *plan;
	struct engine *ended; /* whose buses have ended, for the engine's thread to leave */
	struct log *log;
	const char *instance;
	struct serve *serve;  /* NULL: the owserver protocol is not served */

	struct indicator *indicator;
	pthread_t thread;
	bool running;
	bool left_behind; /* a bus that is stuck in the kernel, with all that it has lent */
	uint32_t stop;
	struct commands *renewed;  /* made by the supervisor, for the engine to take */
	bool unseen;               /* consumers have not been shown it yet */
	uint32_t *bell;            /* in the command segment */
	uint32_t ringing;          /* threads that have just looked where it is */
	int64_t tend_ns;           /* not sooner */
	int64_t image_lost_ns;
	uint64_t idle_rings, mended;
};

enum {
	COUNTER_LOG_DROPPED,
	COUNTER_IDLE_RINGS,
	COUNTER_MENDED,
	COUNTER_WORKER_STALLS,
	COUNTER_DROPPED_EVENTS,
	HOST_COUNTERS,
};
static const char *const host_counters[HOST_COUNTERS] = {
	[COUNTER_LOG_DROPPED] = "log_dropped",
	[COUNTER_IDLE_RINGS] = "idle_rings",
	[COUNTER_MENDED] = "mended_command_headers",
	[COUNTER_WORKER_STALLS] = "worker_stalls",
	[COUNTER_DROPPED_EVENTS] = "dropped_events",
};

static void ring(void *ctx)
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

/* After the bell was exchanged: nobody has his hand on the one before any more. */
static void wait_for_ringers(const struct host *h)
{
	static const uint32_t nobody = 0;

	while (__atomic_load_n(&h->ringing, __ATOMIC_SEQ_CST))
		segment_wait(&nobody, 0, LOOK_NS);
}

static bool take_messages(struct serving *now, int64_t now_ns)
{
	struct worker_message message;
	bool any = false;

	for (unsigned i = 0; i < now->worker_count; i++) {
		/* bounded, so that one bus that talks without end does not keep the others out */
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
	uint64_t stalls = 0, dropped = 0;

	serving_publish(h->now);
	for (unsigned i = 0; i < h->now->worker_count; i++) {
		stalls += worker_stalls(h->now->workers[i]);
		dropped += worker_dropped(h->now->workers[i]);
	}
	image_counter(image, index + COUNTER_LOG_DROPPED, log_dropped(h->log));
	image_counter(image, index + COUNTER_IDLE_RINGS, h->idle_rings);
	image_counter(image, index + COUNTER_MENDED, h->mended);
	image_counter(image, index + COUNTER_WORKER_STALLS, stalls);
	image_counter(image, index + COUNTER_DROPPED_EVENTS, dropped);
	if (h->serve)
		publish_serve_counters(h, index + HOST_COUNTERS);
}

/* The bell goes first: who rings the old one is heard at the next period. */
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

static int show_renewed(struct host *h)
{
	int err = memory_show_commands(&h->now->memory);

	if (!err)
		h->unseen = false;
	return err;
}

static int renew_commands(struct host *h)
{
	struct commands *renewed;
	int err = 0;

	renewed = memory_renew_commands(&h->now->memory, &err);
	if (!renewed)
		return err;
	h->unseen = true;
	__atomic_store_n(&h->renewed, renewed, __ATOMIC_RELEASE);
	ring(h);
	return 0;
}

/* An image of the same values under the name would need all readers to open it: a restart's work. */
static void look_for_image(struct host *h, int64_t now_ns)
{
	if ((h->image_lost_ns && now_ns - h->image_lost_ns < IMAGE_LOST_NS) ||
	    !memory_image_lost(&h->now->memory))
		return;
	h->image_lost_ns = now_ns;
	log_err(h->log,
	        "/dev/shm/owsd.%s.image was removed and programs that start now do not find it: "
	        "restart owsd (of an ordinary user, logind's RemoveIPC= removes it at log-out)",
	        h->instance);
}

void host_tend(struct host *h)
{
	int64_t now_ns = ows_now();
	int err = 0;

	look_for_image(h, now_ns);
	if (__atomic_load_n(&h->renewed, __ATOMIC_ACQUIRE)) /* the engine has not filled it yet */
		return;
	if (now_ns < h->tend_ns)
		return;
	if (h->unseen) {
		err = show_renewed(h);
		h->tend_ns = now_ns + TEND_NS;
	} else if (memory_commands_lost(&h->now->memory)) {
		err = renew_commands(h);
		h->tend_ns = err ? now_ns + TEND_NS : 0;
	}
	if (err)
		log_err(h->log, "the command segment was taken away and cannot be made again: %s",
		        strerror(-err));
}

/* What a reload has made takes over; what it has ended is left. */
static void take_next(struct host *h, int64_t now_ns)
{
	struct serving *next = __atomic_load_n(&h->next, __ATOMIC_ACQUIRE);
	struct engine *ended = __atomic_load_n(&h->ended, __ATOMIC_ACQUIRE);

	if (next) {
		engine_adopt(next->engine, h->now->engine, h->plan, now_ns);
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
			h->mended += commands_mend(h->now->commands, false);
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
		if (bell != h->bell) /* another one: nothing is known of it yet */
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

static int start_thread(struct host *h, int rt_priority, char *why, size_t why_size)
{
	struct sched_param param = { .sched_priority = rt_priority };
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
	/* a synchronous SIGBUS is the guard's and cannot be held back */
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

/* What of the counters is of no bus: the host's own, then the server's. Freed by the caller. */
static struct image_counter *plan_counters(const struct host *h, uint32_t *count)
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
		plan[(*count)++] = (struct image_counter){ host_counters[i], UINT32_MAX };
	for (size_t i = 0; i < n; i++)
		plan[(*count)++] = (struct image_counter){ serve[i].name, UINT32_MAX };
	return plan;
}

static int make_serving(struct host *h, struct config *config, const struct adoption *plan,
                        struct serving **serving, char *why, size_t why_size)
{
	struct serving_setup setup = {
		.config = config,
		.instance = h->instance,
		.log = h->log,
		.ring = ring,
		.ring_ctx = h,
		.guests = h->serve ? serve_guests(h->serve) : NULL,
		.before = h->now,
		.plan = plan,
	};
	struct image_counter *counters = plan_counters(h, &setup.counter_count);
	int err = -ENOMEM;

	snprintf(why, why_size, "%s", strerror(ENOMEM));
	*serving = calloc(1, sizeof(**serving));
	setup.counters = counters;
	if (counters && *serving)
		err = serving_make(*serving, &setup, why, why_size);
	free(counters);
	if (!err)
		return 0;
	free(*serving);
	*serving = NULL;
	return err;
}

static void free_host(struct host *h)
{
	serve_stop(h->serve);
	indicator_destroy(h->indicator);
	if (h->now)
		serving_free(h->now);
	serve_destroy(h->serve);
	free(h->now);
	free(h);
}

static int create_serve(struct host *h, const struct config *config, char *why, size_t why_size)
{
	const struct serve_setup setup = {
		.config = config, .instance = h->instance, .log = h->log, .ring = ring, .ring_ctx = h,
	};

	if (!config->serve.address_count && !config->serve.socket)
		return 0;
	if (serve_is_open(&config->serve))
		log_warning(h->log,
		            "the owserver protocol is served beyond this machine and lets %s write: "
		            "see ListenAllow and ListenReadOnly",
		            config->serve.peer_count ? "all of ListenAllow" : "everybody");
	return serve_create(&setup, &h->serve, why, why_size);
}

static int start_indicator(struct host *h, char *why, size_t why_size)
{
	int err = indicator_create(h->now->config, &h->now->memory.image, h->log, &h->indicator);

	if (!err)
		err = indicator_start(h->indicator);
	if (err)
		snprintf(why, why_size, "cannot start a thread: %s", strerror(-err));
	return err;
}

static int start_workers(struct serving *s, const struct adoption *plan, char *why,
                         size_t why_size)
{
	for (unsigned i = 0; i < s->worker_count; i++) {
		int err = plan && plan->ports[i] >= 0 ? 0 : worker_start(s->workers[i]);

		if (err) {
			snprintf(why, why_size, "cannot start a worker: %s", strerror(-err));
			return err;
		}
	}
	return 0;
}

int host_start(const struct host_setup *setup, struct host **host, char *why, size_t why_size)
{
	struct host *h = calloc(1, sizeof(*h));
	int err;

	snprintf(why, why_size, "%s", strerror(ENOMEM));
	if (!h) {
		config_free(setup->config);
		return -ENOMEM;
	}
	h->log = setup->log;
	h->instance = setup->instance;
	err = create_serve(h, setup->config, why, why_size);
	if (!err)
		err = make_serving(h, setup->config, NULL, &h->now, why, why_size);
	if (err) {
		free_host(h); /* the server's socket has its path in the configuration */
		config_free(setup->config);
		return err;
	}
	err = memory_show(&h->now->memory, h->log);
	if (err) {
		snprintf(why, why_size, "cannot put the shared memory in place: %s",
		         strerror(-err));
		goto fail;
	}
	h->bell = commands_bell(h->now->commands);
	err = start_thread(h, setup->rt_priority, why, why_size);
	if (err)
		goto fail;
	err = start_workers(h->now, NULL, why, why_size);
	if (!err && h->serve) {
		err = serve_start(h->serve, &h->now->memory.image);
		if (err)
			snprintf(why, why_size, "cannot serve the owserver protocol: %s",
			         strerror(-err));
	}
	if (!err)
		err = start_indicator(h, why, why_size);
	if (err) {
		host_stop(h, 1000000000);
		return err;
	}
	*host = h;
	return 0;
fail:
	free_host(h);
	return err;
}

/* --- Reload ---------------------------------------------------------------------------------- */

static void pause_until_null(void *word)
{
	static const uint32_t nobody = 0;

	while (__atomic_load_n((void **)word, __ATOMIC_ACQUIRE))
		segment_wait(&nobody, 0, LOOK_NS);
}

/* Those that did not stay; false: one of them does not end. */
static bool end_workers(struct serving *before, const struct serving *now,
                        const struct adoption *plan)
{
	bool ended = true;

	for (unsigned i = 0; i < now->worker_count; i++)
		if (plan->ports[i] >= 0)
			before->taken[plan->ports[i]] = true;
	for (unsigned i = 0; i < before->worker_count; i++)
		if (!before->taken[i])
			ended &= worker_stop(before->workers[i], END_NS) == 0;
	return ended;
}

/* ended: its buses have; dark: the lamps that look at its image have. */
static void leave(struct host *h, struct serving *before, bool ended, bool dark)
{
	if (ended) {
		__atomic_store_n(&h->ended, before->engine, __ATOMIC_RELEASE);
		ring(h);
		pause_until_null(&h->ended);
	} else {
		log_err(h->log, "a bus that the reload ended is stuck in the kernel; "
		                "owsd leaves it behind");
	}
	if (!dark)
		log_err(h->log, "AlarmLine or HeartbeatLine is stuck in the kernel; "
		                "owsd leaves it behind");
	wait_for_ringers(h);
	if (dark)
		memory_replaced(&before->memory);
	if (!ended || !dark) {
		h->left_behind = true;
		return;
	}
	serving_free(before);
	free(before);
}

static bool same_listeners(const struct config_serve *a, const struct config_serve *b)
{
	return a->address_count == b->address_count && a->peer_count == b->peer_count &&
	       a->read_only == b->read_only && !a->socket == !b->socket &&
	       (!a->socket || strcmp(a->socket, b->socket) == 0) &&
	       memcmp(a->addresses, b->addresses, sizeof(a->addresses)) == 0 &&
	       memcmp(a->peers, b->peers, sizeof(a->peers)) == 0;
}

/* The engine serves it from here on; nothing of what follows can refuse it any more. */
static void exchange(struct host *h, struct serving *next, const struct adoption *plan)
{
	struct serving *before = h->now;
	char why[256];
	bool dark;
	int err;

	h->plan = plan;
	__atomic_store_n(&h->next, next, __ATOMIC_RELEASE);
	ring(h);
	pause_until_null(&h->next);
	h->plan = NULL;
	err = memory_show(&next->memory, h->log);
	if (err)
		log_err(h->log, "cannot put the shared memory in place: %s", strerror(-err));
	if (h->serve)
		serve_reload(h->serve, next->config, &next->memory.image, plan->ports);
	dark = indicator_stop(h->indicator, END_NS);
	if (dark)
		indicator_destroy(h->indicator);
	h->indicator = NULL;
	leave(h, before, end_workers(before, next, plan), dark);
	if (start_workers(next, plan, why, sizeof(why)) || start_indicator(h, why, sizeof(why)))
		log_err(h->log, "%s", why);
}

int host_reload(struct host *h, struct config *config, char *why, size_t why_size)
{
	struct adoption plan;
	struct serving *next;
	int err;

	if (h->unseen || __atomic_load_n(&h->renewed, __ATOMIC_ACQUIRE))
		return -EAGAIN;
	if (!same_listeners(&config->serve, &h->now->config->serve)) {
		snprintf(why, why_size, "what Listen, ListenSocket, ListenAllow and ListenReadOnly "
		                        "say is changed by a restart only");
		return -EBUSY;
	}
	snprintf(why, why_size, "%s", strerror(ENOMEM));
	if (h->serve && serve_prepare(h->serve, config))
		return -ENOMEM;
	err = adoption_plan(&plan, config, h->now->config);
	if (err)
		return err;
	err = make_serving(h, config, &plan, &next, why, why_size);
	if (!err) {
		log_notice(h->log, "reload: %u signals, %u of them go on; %u targets, %u of them",
		           config->item_count, plan.kept_rows, config->target_count,
		           plan.kept_ports);
		exchange(h, next, &plan);
	}
	adoption_free(&plan);
	return err;
}

int64_t host_beat(const struct host *host)
{
	struct ows_sample sample;

	return reader_sample(&host->now->memory.image.records[0], &sample) ? sample.measured_ns : 0;
}

const struct config *host_config(const struct host *host)
{
	return host->now->config;
}

bool host_stop(struct host *h, int64_t timeout_ns)
{
	bool stuck = false;

	/* first what others could wait for: ports and clients */
	serve_stop(h->serve);
	__atomic_store_n(&h->stop, 1, __ATOMIC_RELEASE);
	if (h->running) {
		ring(h);
		pthread_join(h->thread, NULL);
	}
	stuck = !indicator_stop(h->indicator, timeout_ns) || h->left_behind;
	for (unsigned i = 0; i < h->now->worker_count; i++)
		stuck |= worker_stop(h->now->workers[i], timeout_ns) != 0;
	if (stuck) {
		/* who comes back from the kernel now still rings in it, and looks at it */
		memory_stop(&h->now->memory);
		return false;
	}
	free_host(h);
	return true;
}
