/* SPDX-License-Identifier: MIT */
#include "host.h"

#include "hal/worker.h"
#include "indicator.h"
#include "libows/ows.h"
#include "serve/serve.h"
#include "shm/reader.h"
#include "target.h"

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

struct host {
	const struct config *config;
	struct log *log;
	struct memory memory;
	struct engine *engine;
	struct engine_port *ports;
	struct worker **workers;
	unsigned worker_count;
	unsigned *bus_counters; /* how many each worker's bus has */
	unsigned own_counters;  /* index of the first one of the host itself, then the server's */
	struct serve *serve;    /* NULL: the owserver protocol is not served */

	struct indicator *indicator;
	pthread_t thread;
	bool running;
	uint32_t stop;
	struct commands *commands; /* as the engine uses them */
	struct commands *renewed;  /* made by the supervisor, for the engine to take */
	bool unseen;               /* consumers have not been shown it yet */
	uint32_t *bell;            /* in the command segment */
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
	uint32_t *bell = __atomic_load_n(&h->bell, __ATOMIC_ACQUIRE);

	if (!bell)
		return;
	__atomic_fetch_add(bell, 1, __ATOMIC_SEQ_CST);
	segment_wake(bell, 1);
}

static int submit(void *ctx, struct bus_req *req)
{
	return worker_submit(ctx, req);
}

static void suspend(void *ctx, bool yes)
{
	worker_suspend(ctx, yes);
}

static bool take_messages(struct host *h, int64_t now_ns)
{
	struct worker_message message;
	bool any = false;

	for (unsigned i = 0; i < h->worker_count; i++) {
		/* bounded, so that one bus that talks without end does not keep the others out */
		for (unsigned n = 0; n < 2 * BUS_MAX_DEPTH; n++) {
			if (!worker_next(h->workers[i], &message))
				break;
			any = true;
			if (message.is_event)
				engine_event(h->engine, i, &message.event, now_ns);
			else
				engine_answer(h->engine, i, &message.answer, now_ns);
		}
	}
	return any;
}

static void publish_serve_counters(struct host *h, uint32_t index)
{
	size_t n;
	const struct bus_counter *c = serve_counters(h->serve, &n);

	for (size_t i = 0; i < n; i++)
		image_counter(&h->memory.image, index++, bus_counted(&c[i]));
}

static void publish_counters(struct host *h)
{
	uint32_t index = engine_counter_count(h->worker_count);
	uint64_t stalls = 0, dropped = 0;

	for (unsigned i = 0; i < h->worker_count; i++) {
		size_t n;
		const struct bus_counter *c = bus_counters(worker_bus(h->workers[i]), &n);

		for (size_t k = 0; k < h->bus_counters[i]; k++)
			image_counter(&h->memory.image, index++, bus_counted(&c[k]));
		stalls += worker_stalls(h->workers[i]);
		dropped += worker_dropped(h->workers[i]);
	}
	index = h->own_counters;
	image_counter(&h->memory.image, index + COUNTER_LOG_DROPPED, log_dropped(h->log));
	image_counter(&h->memory.image, index + COUNTER_IDLE_RINGS, h->idle_rings);
	image_counter(&h->memory.image, index + COUNTER_MENDED, h->mended);
	image_counter(&h->memory.image, index + COUNTER_WORKER_STALLS, stalls);
	image_counter(&h->memory.image, index + COUNTER_DROPPED_EVENTS, dropped);
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
	h->commands = renewed;
	engine_take_commands(h->engine, renewed, now_ns);
	__atomic_store_n(&h->renewed, NULL, __ATOMIC_RELEASE);
}

static int show_renewed(struct host *h)
{
	int err = memory_show_commands(&h->memory);

	if (!err)
		h->unseen = false;
	return err;
}

static int renew_commands(struct host *h)
{
	struct commands *renewed;
	int err = 0;

	renewed = memory_renew_commands(&h->memory, &err);
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
	    !memory_image_lost(&h->memory))
		return;
	h->image_lost_ns = now_ns;
	log_err(h->log,
	        "/dev/shm/owsd.%s.image was removed and programs that start now do not find it: "
	        "restart owsd (of an ordinary user, logind's RemoveIPC= removes it at log-out)",
	        h->memory.instance);
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
	} else if (memory_commands_lost(&h->memory)) {
		err = renew_commands(h);
		h->tend_ns = err ? now_ns + TEND_NS : 0;
	}
	if (err)
		log_err(h->log, "the command segment was taken away and cannot be made again: %s",
		        strerror(-err));
}

static void sleep_until(struct host *h, uint32_t seen, int64_t until_ns)
{
	int64_t now_ns = ows_now();

	if (until_ns <= now_ns)
		return;
	commands_awake(h->commands, false);
	segment_wait(h->bell, seen, until_ns - now_ns);
	commands_awake(h->commands, true);
}

static void *engine_main(void *ctx)
{
	struct host *h = ctx;
	int64_t counted_ns = 0;
	unsigned idle = 0;

	while (!__atomic_load_n(&h->stop, __ATOMIC_ACQUIRE)) {
		uint32_t seen = __atomic_load_n(h->bell, __ATOMIC_ACQUIRE);
		int64_t now_ns = ows_now(), next_ns;
		bool busy = take_messages(h, now_ns);

		next_ns = engine_step(h->engine, now_ns);
		if (now_ns - counted_ns >= h->config->period_ns) {
			counted_ns = now_ns;
			h->mended += commands_mend(h->commands, false);
			publish_counters(h);
			busy = true;
		}
		if (engine_published(h->engine)) {
			busy = true;
			image_news(&h->memory.image);
			segment_wake(&h->memory.image.header->news, INT_MAX);
		}
		take_renewed(h, now_ns);
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

/* Of several ways to one wire the first is open at the start. */
static int create_workers(struct host *h, char *why, size_t why_size)
{
	int err = 0;

	h->workers = calloc(h->config->target_count, sizeof(*h->workers));
	h->ports = calloc(h->config->target_count, sizeof(*h->ports));
	h->bus_counters = calloc(h->config->target_count, sizeof(*h->bus_counters));
	if (!h->workers || !h->ports || !h->bus_counters)
		return -ENOMEM;
	for (unsigned i = 0; i < h->config->target_count && !err; i++) {
		const struct config_target *planned = &h->config->targets[i];
		const char *target = planned->text;
		char reason[256] = "", name[24];
		size_t n = 0;

		snprintf(name, sizeof(name), "owsd-bus%u", i);
		err = worker_create(target, name, ring, h, &h->workers[i], reason,
		                    sizeof(reason));
		if (err) {
			snprintf(why, why_size, "target %s: %s", target,
			         *reason ? reason : strerror(-err));
			break;
		}
		h->worker_count++;
		err = target_options(worker_bus(h->workers[i]), h->config, target, reason,
		                     sizeof(reason));
		if (err) {
			snprintf(why, why_size, "target %s: %s", target, reason);
			break;
		}
		bus_counters(worker_bus(h->workers[i]), &n);
		h->bus_counters[i] = (unsigned)n;
		if (planned->relation == CONFIG_BAR)
			worker_suspend(h->workers[i], true);
		h->ports[i] = (struct engine_port){
			.target = target,
			.depth = bus_depth(worker_bus(h->workers[i])),
			.searches = worker_bus(h->workers[i])->ops->searches,
			.submit = submit,
			.ctx = h->workers[i],
			.group = planned->group,
			.suspend = suspend,
		};
	}
	return err;
}

/* Engine's counters, then each bus's, then the host's own. */
static int make_memory(struct host *h, const char *instance, char *why, size_t why_size)
{
	unsigned count = engine_counter_count(h->worker_count), first = count;
	const struct bus_counter *serve = NULL;
	struct image_counter *plan;
	char (*names)[48];
	size_t serve_count = 0;
	int err;

	h->own_counters = count;
	for (unsigned i = 0; i < h->worker_count; i++)
		h->own_counters += h->bus_counters[i];
	if (h->serve)
		serve = serve_counters(h->serve, &serve_count);
	plan = calloc(h->own_counters + HOST_COUNTERS + serve_count, sizeof(*plan));
	names = calloc(h->own_counters - count + 1, sizeof(*names));
	if (!plan || !names) {
		free(plan);
		free(names);
		return -ENOMEM;
	}
	engine_counter_plan(h->worker_count, plan);
	for (unsigned i = 0; i < h->worker_count; i++) {
		size_t n;
		const struct bus_counter *c = bus_counters(worker_bus(h->workers[i]), &n);

		for (size_t k = 0; k < h->bus_counters[i]; k++, count++) {
			snprintf(names[count - first], sizeof(*names), "bus_%s", c[k].name);
			plan[count] = (struct image_counter){ names[count - first], i };
		}
	}
	for (unsigned i = 0; i < HOST_COUNTERS; i++)
		plan[count++] = (struct image_counter){ host_counters[i], UINT32_MAX };
	for (size_t i = 0; i < serve_count; i++)
		plan[count++] = (struct image_counter){ serve[i].name, UINT32_MAX };
	err = memory_make(&h->memory, instance, h->config, plan, count, h->log, why, why_size);
	free(plan);
	free(names);
	return err;
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

static void free_host(struct host *h)
{
	serve_stop(h->serve);
	indicator_destroy(h->indicator);
	engine_destroy(h->engine);
	for (unsigned i = 0; i < h->worker_count; i++)
		worker_destroy(h->workers[i]);
	serve_destroy(h->serve);
	memory_end(&h->memory);
	free(h->workers);
	free(h->ports);
	free(h->bus_counters);
	free(h);
}

static int create_serve(struct host *h, const char *instance, char *why, size_t why_size)
{
	const struct config_serve *config = &h->config->serve;
	const struct serve_setup setup = {
		.config = h->config, .instance = instance, .log = h->log, .ring = ring, .ring_ctx = h,
	};

	if (!config->address_count && !config->socket)
		return 0;
	if (serve_is_open(config))
		log_warning(h->log,
		            "the owserver protocol is served beyond this machine and lets %s write: "
		            "see ListenAllow and ListenReadOnly",
		            config->peer_count ? "all of ListenAllow" : "everybody");
	return serve_create(&setup, &h->serve, why, why_size);
}

int host_start(const struct host_setup *setup, struct host **host, char *why, size_t why_size)
{
	struct engine_setup engine;
	struct host *h = calloc(1, sizeof(*h));
	int err;

	snprintf(why, why_size, "%s", strerror(ENOMEM));
	if (!h)
		return -ENOMEM;
	h->config = setup->config;
	h->log = setup->log;
	err = create_workers(h, why, why_size);
	if (!err)
		err = create_serve(h, setup->instance, why, why_size);
	if (!err)
		err = make_memory(h, setup->instance, why, why_size);
	if (err)
		goto fail;
	h->commands = memory_commands(&h->memory);
	engine = (struct engine_setup){
		.config = h->config,
		.ports = h->ports,
		.port_count = h->worker_count,
		.image = &h->memory.image,
		.commands = h->commands,
		.log = h->log,
		.guests = h->serve ? serve_guests(h->serve) : NULL,
		.start_ns = h->memory.start_ns,
	};
	err = engine_create(&engine, &h->engine);
	if (err)
		goto fail;
	err = memory_show(&h->memory, h->log);
	if (err) {
		snprintf(why, why_size, "cannot put the shared memory in place: %s",
		         strerror(-err));
		goto fail;
	}
	h->bell = commands_bell(h->commands);
	err = start_thread(h, setup->rt_priority, why, why_size);
	for (unsigned i = 0; !err && i < h->worker_count; i++) {
		err = worker_start(h->workers[i]);
		if (err) {
			snprintf(why, why_size, "cannot start a worker: %s", strerror(-err));
			host_stop(h, 1000000000);
			return err;
		}
	}
	if (err)
		goto fail;
	if (h->serve)
		err = serve_start(h->serve, &h->memory.image);
	if (err) {
		snprintf(why, why_size, "cannot serve the owserver protocol: %s", strerror(-err));
		host_stop(h, 1000000000);
		return err;
	}
	err = indicator_create(h->config, &h->memory.image, h->log, &h->indicator);
	if (!err)
		err = indicator_start(h->indicator);
	if (err) {
		snprintf(why, why_size, "cannot start a thread: %s", strerror(-err));
		host_stop(h, 1000000000);
		return err;
	}
	*host = h;
	return 0;
fail:
	free_host(h);
	return err;
}

int64_t host_beat(const struct host *host)
{
	struct ows_sample sample;

	return reader_sample(&host->memory.image.records[0], &sample) ? sample.measured_ns : 0;
}

unsigned host_signals(const struct host *host)
{
	return host->config->item_count;
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
	stuck = !indicator_stop(h->indicator, timeout_ns);
	for (unsigned i = 0; i < h->worker_count; i++)
		stuck |= worker_stop(h->workers[i], timeout_ns) != 0;
	if (stuck) {
		/* who comes back from the kernel now rings no more */
		__atomic_store_n(&h->bell, NULL, __ATOMIC_RELEASE);
		memory_end(&h->memory);
		return false;
	}
	free_host(h);
	return true;
}
