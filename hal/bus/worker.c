/* SPDX-License-Identifier: MIT */
/*
 * The thread of a bus: takes orders from the engine, runs the bus, and queues its answers and
 * events.
 */
#include <assert.h>
#include <errno.h>
#include <poll.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "hal/base/bell.h"
#include "hal/base/ring.h"
#include "hal/base/thread.h"
#include "hal/base/time.h"
#include "hal/bus/backends.h"
#include "hal/bus/worker.h"

#define STACK_SIZE (256 * 1024)
/* Relative time-outs do not count suspend: read the clock again this often. */
#define LONGEST_WAIT (10 * NS_PER_S)
/* A wait that ends so much too late was stopped in between: it goes on for a moment, once. */
#define LATE_NS (100 * NS_PER_MS)
#define GRACE_NS (250 * NS_PER_MS)
#define FULL_NAP (NS_PER_S / 1000)
#define EVENT_NAPS 200 /* then the event is dropped */
#define EVENT_ROOM 24

struct worker {
	struct bus *bus;
	struct bus_env env;
	worker_bell *bell;
	void *bell_ctx;
	char name[16];

	struct ring orders;
	struct bus_req **order;
	struct ring messages;
	struct worker_message *message;
	bool lent; /* worker_next() returned a message, which is still in its cell */
	struct bus_counter stalls, dropped;

	int wake_fd;
	int64_t rest_ns;   /* of thread_yield() */
	uint32_t sleeping; /* the thread waits for orders: wake it */
	uint32_t stopping;
	/* Calls of bus_suspend() asked for and done: odd ones suspend, even ones take again. */
	uint32_t suspends_asked, suspends_done;

	bool started;
	pthread_t thread;
	pthread_mutex_t mutex;
	pthread_cond_t ended_cond;
	bool ended;
};

static bool is_stopping(const struct worker *worker)
{
	return __atomic_load_n(&worker->stopping, __ATOMIC_SEQ_CST);
}

/* One ppoll: 1 fd is ready, 0 not. Clears wake-ups; the caller looks for their reason. */
static int poll_once(struct worker *worker, int fd, short events, int64_t until_ns)
{
	struct pollfd fds[2] = {{.fd = worker->wake_fd, .events = POLLIN},
	                        {.fd = fd, .events = events}};
	int64_t left = until_ns - clock_ns(CLOCK_BOOTTIME);
	struct timespec t = timespec_of(left > 0 ? earlier_ns(left, LONGEST_WAIT) : 0);

	if (ppoll(fds, fd >= 0 ? 2 : 1, &t, NULL) <= 0)
		return 0;
	if (fds[0].revents)
		bell_clear(worker->wake_fd);
	return fd >= 0 && fds[1].revents;
}

static int64_t env_now(void *ctx)
{
	(void)ctx;
	return clock_ns(CLOCK_BOOTTIME);
}

static int env_wait(void *ctx, int fd, short events, int64_t until_ns)
{
	struct worker *worker = ctx;
	int64_t now_ns = clock_ns(CLOCK_BOOTTIME);
	bool again = fd >= 0 && now_ns < until_ns;

	while (!is_stopping(worker)) {
		if (poll_once(worker, fd, events, until_ns))
			return 1;
		now_ns = clock_ns(CLOCK_BOOTTIME);
		/* what was sent while the machine slept, or by one that slept too, is to come */
		if (again && now_ns > until_ns + LATE_NS) {
			again = false;
			until_ns = now_ns + GRACE_NS;
		}
		if (now_ns >= until_ns)
			return 0;
	}
	return -ECANCELED;
}

/* The cell of the next message, which is put when it is filled. */
static struct worker_message *cell(struct worker *worker)
{
	return &worker->message[ring_put_at(&worker->messages)];
}

static void put_message(struct worker *worker)
{
	ring_did_put(&worker->messages);
	if (worker->bell)
		worker->bell(worker->bell_ctx);
}

/* False: the queue stayed as full as `full`, for `naps` or until the end. */
static bool wait_for_room(struct worker *worker, uint32_t full, unsigned naps)
{
	if (ring_used(&worker->messages) < full)
		return true;
	bus_count(&worker->stalls, 1);
	for (unsigned i = 0; i < naps && !is_stopping(worker); i++) {
		poll_once(worker, -1, 0, clock_ns(CLOCK_BOOTTIME) + FULL_NAP);
		if (ring_used(&worker->messages) < full)
			return true;
	}
	return false;
}

/* An answer is never dropped: the engine lent the request's memory until it has the answer. */
static void env_answer(void *ctx, const struct bus_answer *answer)
{
	struct worker *worker = ctx;

	while (!wait_for_room(worker, worker->messages.size, EVENT_NAPS))
		if (is_stopping(worker))
			return;
	cell(worker)->is_event = false;
	cell(worker)->answer = *answer;
	put_message(worker);
}

/* Events leave room for an answer to each request that the bus can hold. */
static void env_event(void *ctx, const struct bus_event *event)
{
	struct worker *worker = ctx;
	uint32_t full = worker->messages.size - bus_depth(worker->bus);

	if (!wait_for_room(worker, full, EVENT_NAPS)) {
		bus_count(&worker->dropped, 1);
		return;
	}
	cell(worker)->is_event = true;
	cell(worker)->event = *event;
	put_message(worker);
}

static void take_orders(struct worker *worker)
{
	while (ring_used(&worker->orders)) {
		if (bus_submit(worker->bus, worker->order[ring_take_at(&worker->orders)]))
			return;
		ring_did_take(&worker->orders);
	}
}

static bool suspend_is_due(const struct worker *worker)
{
	return __atomic_load_n(&worker->suspends_asked, __ATOMIC_SEQ_CST) != worker->suspends_done;
}

static void take_suspends(struct worker *worker)
{
	while (suspend_is_due(worker)) {
		worker->suspends_done++;
		bus_suspend(worker->bus, worker->suspends_done & 1);
	}
}

/* `sleeping` is set before the last look: an order that comes after that look rings the bell. */
static void sleep_until(struct worker *worker, int64_t until_ns)
{
	/* the engine, which the bell woke, may have its next order at once */
	if (thread_yield(&worker->rest_ns) && ring_used(&worker->orders))
		return;
	__atomic_store_n(&worker->sleeping, 1, __ATOMIC_SEQ_CST);
	if (!ring_used(&worker->orders) && !suspend_is_due(worker) && !is_stopping(worker))
		worker->bus->stirred = poll_once(worker, bus_watch(worker->bus), POLLIN, until_ns);
	__atomic_store_n(&worker->sleeping, 0, __ATOMIC_SEQ_CST);
}

static void *worker_main(void *arg)
{
	struct worker *worker = arg;

	while (!is_stopping(worker)) {
		uint32_t left;
		int64_t next;

		take_orders(worker);
		take_suspends(worker);
		left = ring_used(&worker->orders);
		next = bus_step(worker->bus, clock_ns(CLOCK_BOOTTIME));
		/* Orders that the bus had no room for wait until the bus wants its next step. */
		if (left && next > clock_ns(CLOCK_BOOTTIME))
			poll_once(worker, -1, 0, next);
		else if (next > clock_ns(CLOCK_BOOTTIME))
			sleep_until(worker, next);
	}
	pthread_mutex_lock(&worker->mutex);
	worker->ended = true;
	pthread_cond_signal(&worker->ended_cond);
	pthread_mutex_unlock(&worker->mutex);
	return NULL;
}

static int make_lock(struct worker *worker)
{
	pthread_condattr_t attr;
	int err = pthread_condattr_init(&attr);

	if (err)
		return -err;
	err = pthread_condattr_setclock(&attr, CLOCK_MONOTONIC);
	if (!err)
		err = pthread_cond_init(&worker->ended_cond, &attr);
	pthread_condattr_destroy(&attr);
	if (!err)
		err = pthread_mutex_init(&worker->mutex, NULL);
	return -err;
}

int worker_create(const char *target, const char *name, worker_bell *bell, void *ctx,
                  struct worker **out, char *why, size_t why_size)
{
	struct worker *worker = calloc(1, sizeof(*worker));
	unsigned depth;
	int err;

	if (!worker) {
		snprintf(why, why_size, "'%.80s': out of memory", target);
		return -ENOMEM;
	}
	worker->env = (struct bus_env){.ctx = worker,
	                               .now = env_now,
	                               .wait = env_wait,
	                               .answer = env_answer,
	                               .event = env_event};
	worker->bell = bell;
	worker->bell_ctx = ctx;
	snprintf(worker->name, sizeof(worker->name), "%s", name);
	worker->wake_fd = bell_open();
	err = worker->wake_fd < 0 ? -errno : make_lock(worker);
	if (err) {
		snprintf(why, why_size, "'%.80s': %s", target, strerror(-err));
		if (worker->wake_fd >= 0)
			close(worker->wake_fd);
		free(worker);
		return err;
	}
	err = bus_create(target, &worker->env, &worker->bus, why, why_size);
	if (!err) {
		depth = bus_depth(worker->bus);
		worker->orders.size = ring_size(depth);
		worker->messages.size = ring_size(2 * depth + EVENT_ROOM);
		worker->order = calloc(worker->orders.size, sizeof(*worker->order));
		worker->message = calloc(worker->messages.size, sizeof(*worker->message));
		if (!worker->order || !worker->message) {
			snprintf(why, why_size, "'%.80s': out of memory", target);
			err = -ENOMEM;
		}
	}
	if (err) {
		worker_destroy(worker);
		return err;
	}
	*out = worker;
	return 0;
}

int worker_start(struct worker *worker)
{
	int err;

	assert(!worker->started);
	err = thread_start(&worker->thread, worker->name, STACK_SIZE, worker_main, worker);
	worker->started = !err;
	return err;
}

bool worker_started(const struct worker *worker)
{
	return worker->started;
}

struct bus *worker_bus(struct worker *worker)
{
	return worker->bus;
}

int worker_submit(struct worker *worker, struct bus_req *req)
{
	if (ring_used(&worker->orders) >= bus_depth(worker->bus))
		return -EAGAIN;
	worker->order[ring_put_at(&worker->orders)] = req;
	ring_did_put(&worker->orders);
	if (__atomic_exchange_n(&worker->sleeping, 0, __ATOMIC_SEQ_CST))
		bell_ring(worker->wake_fd);
	return 0;
}

void worker_suspend(struct worker *worker, bool yes)
{
	uint32_t asked = worker->suspends_asked;

	if ((asked & 1) == yes)
		return;
	__atomic_store_n(&worker->suspends_asked, asked + 1, __ATOMIC_SEQ_CST);
	bell_ring(worker->wake_fd);
}

const struct worker_message *worker_next(struct worker *worker)
{
	if (worker->lent)
		ring_did_take(&worker->messages);
	worker->lent = ring_used(&worker->messages) > 0;
	return worker->lent ? &worker->message[ring_take_at(&worker->messages)] : NULL;
}

int worker_stop(struct worker *worker, int64_t timeout_ns)
{
	int64_t until = clock_ns(CLOCK_MONOTONIC) + timeout_ns;
	struct timespec t = timespec_of(until);
	int err = 0;

	if (!worker->started)
		return 0;
	__atomic_store_n(&worker->stopping, 1, __ATOMIC_SEQ_CST);
	bell_ring(worker->wake_fd);
	pthread_mutex_lock(&worker->mutex);
	while (!worker->ended && !err)
		err = pthread_cond_timedwait(&worker->ended_cond, &worker->mutex, &t);
	err = worker->ended ? 0 : -ETIMEDOUT;
	pthread_mutex_unlock(&worker->mutex);
	if (err)
		return err;
	pthread_join(worker->thread, NULL);
	worker->started = false;
	return 0;
}

void worker_destroy(struct worker *worker)
{
	if (!worker)
		return;
	assert(!worker->started);
	bus_destroy(worker->bus);
	pthread_cond_destroy(&worker->ended_cond);
	pthread_mutex_destroy(&worker->mutex);
	close(worker->wake_fd);
	free(worker->order);
	free(worker->message);
	free(worker);
}

uint64_t worker_stalls(const struct worker *worker)
{
	return bus_counted(&worker->stalls);
}

uint64_t worker_dropped(const struct worker *worker)
{
	return bus_counted(&worker->dropped);
}
