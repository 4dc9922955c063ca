/* SPDX-License-Identifier: MIT */
/* The inside of the host, which the files of this room share. */
#ifndef HOST_PRIVATE_H
#define HOST_PRIVATE_H

#include <pthread.h>

#include "src/host/host.h"
#include "src/host/serving.h"

/*
 * The supervisor's pause between two looks whether engine or server have taken what it gave them.
 */
#define HOST_LOOK_NS 1000000

struct host {
	struct serving
		*now; /* exchanged by the engine's thread; else only the supervisor uses it */
	struct serving *next; /* made by a reload, for the engine to take over */
	const struct adoption *plan;
	struct engine
		*ended; /* an engine whose buses have ended, for the engine's thread to abandon */
	struct log *log;
	const char *instance;
	struct serve *serve; /* NULL: the owserver protocol is not served */

	struct indicator *indicator;
	pthread_t thread;
	bool running;
	bool left_behind; /* a bus is stuck in the kernel, and keeps the memory that it uses */
	uint32_t stop;
	struct commands *renewed; /* made by the supervisor, for the engine to take */
	bool unseen;              /* renewed is not yet shown to consumers */
	uint32_t *bell;           /* in the command segment */
	uint32_t ringing;         /* how many threads have read bell and not yet rung it */
	int64_t tend_ns;          /* not sooner */
	struct log_rate tend_rate;
	int64_t image_lost_ns;
	/*
	 * what a reload has not finished: its image is not in place, its threads do not run; how
	 * many
	 */
	bool unshown, unstarted;
	uint32_t unfinished;
	int64_t finish_ns; /* not sooner */
	struct log_rate finish_rate;
	uint64_t idle_rings, mended;
};

/* engine_thread.c. Start the engine's thread: 0, or a negative errno with the reason in why. */
int host_start_engine(struct host *host, int rt_priority, char *why, size_t why_size);
/* Wake the engine, from any thread. */
void host_ring(void *host);
/* After the bell was exchanged: wait until no thread can ring the bell before any more. */
void host_wait_for_ringers(const struct host *host);
/*
 * The counters that belong to no bus: the host's own, then the server's. The caller frees the plan.
 */
struct image_counter *host_plan_counters(const struct host *host, uint32_t *count);

/* host.c. Returns 0, or a negative errno with the reason in why; plan NULL: a start. */
int host_make_serving(struct host *host, struct config *config, const struct adoption *plan,
                      struct serving **serving, char *why, size_t why_size);
/* Start all workers that do not run yet; returns the error of the first that cannot be started. */
int host_start_workers(struct serving *serving, char *why, size_t why_size);
int host_start_indicator(struct host *host, char *why, size_t why_size);

/*
 * tend.c. Try again what a reload could not finish after the engine had taken it; log and count it
 * until it is done. host_tend() calls it once a second.
 */
void host_finish_reload(struct host *host);

#endif
