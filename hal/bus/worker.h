/* SPDX-License-Identifier: MIT */
/*
 * A worker: the thread that runs one bus, and the two bounded queues between it and the engine.
 * The engine's side never blocks: worker_submit() writes one eventfd, worker_next() reads memory.
 * A worker that is stuck in the kernel stalls no other thread: worker_stop() reports that and
 * returns.
 */
#pragma once

#include "hal/bus/bus.h"

struct worker;

/* What a worker tells: an answer or an event, in the order in which the bus gave them. */
struct worker_message {
	bool is_event;
	union {
		struct bus_answer answer;
		struct bus_event event;
	};
};

/* Rung after each message; called on the worker's thread; must not block. */
typedef void worker_bell(void *ctx);

/*
 * Create bus and queues for target; the thread starts with worker_start(). Errors as bus_create().
 * name (15 bytes are used) names the thread.
 */
int worker_create(const char *target, const char *name, worker_bell *bell, void *ctx,
                  struct worker **worker, char *why, size_t why_size);
/* 0 or a negative errno; it may be tried again then. */
int worker_start(struct worker *worker);
bool worker_started(const struct worker *worker);
struct bus *worker_bus(struct worker *worker);

/* Engine thread only. 0, or -EAGAIN: queue full. */
int worker_submit(struct worker *worker, struct bus_req *req);
/*
 * Engine thread only, or before worker_start() for a bus that starts suspended: bus_suspend() on
 * the worker's thread, in the order asked for. Never blocks and cannot fail; a worker that is stuck
 * in the kernel carries it out when it comes back.
 */
void worker_suspend(struct worker *worker, bool yes);
/* Engine thread only: the next message, valid until the next call; NULL when there is none. */
const struct worker_message *worker_next(struct worker *worker);

/*
 * Ask the thread to end: its waits return -ECANCELED. Returns 0 when it ended within timeout_ns,
 * -ETIMEDOUT when it is stuck (then worker_destroy() must not be called, the process ends). May be
 * called again to wait longer; with 0 it only asks.
 */
int worker_stop(struct worker *worker, int64_t timeout_ns);
void worker_destroy(struct worker *worker);

/*
 * Any thread. Messages that found the queue full and had to wait; events that were dropped because
 * it stayed full. Answers are never dropped while the worker runs.
 */
uint64_t worker_stalls(const struct worker *worker);
uint64_t worker_dropped(const struct worker *worker);
