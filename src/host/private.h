/* SPDX-License-Identifier: MIT */
/* The inside of the host, shared by host.c, host_engine.c and host_reload.c. */
#ifndef HOST_PRIVATE_H
#define HOST_PRIVATE_H

#include <pthread.h>

#include "src/host/host.h"
#include "src/host/serving.h"

/* How long the supervisor looks whether the engine, the server have taken what it gave them. */
#define HOST_LOOK_NS 1000000

struct host {
	struct serving *now;  /* the engine's thread exchanges it, the supervisor alone else */
	struct serving *next; /* of a reload, for the engine to take over */
	const struct adoption *plan;
	struct engine *ended; /* whose buses have ended, for the engine's thread to leave */
	struct log *log;
	const char *instance;
	struct serve *serve; /* NULL: the owserver protocol is not served */

	struct indicator *indicator;
	pthread_t thread;
	bool running;
	bool left_behind; /* a bus that is stuck in the kernel, with all that it has lent */
	uint32_t stop;
	struct commands *renewed; /* made by the supervisor, for the engine to take */
	bool unseen;              /* consumers have not been shown it yet */
	uint32_t *bell;           /* in the command segment */
	uint32_t ringing;         /* threads that have just looked where it is */
	int64_t tend_ns;          /* not sooner */
	struct log_rate tend_rate;
	int64_t image_lost_ns;
	/* of a reload: its image is not in place, threads of it do not run; how many of the two */
	bool unshown, unstarted;
	uint32_t unmended;
	int64_t mend_ns; /* not sooner */
	struct log_rate mend_rate;
	uint64_t idle_rings, mended;
};

/* host_engine.c. Start the thread: 0 or a negative errno, the reason then stands in why. */
int host_start_engine(struct host *host, int rt_priority, char *why, size_t why_size);
/* Wake it, from any thread. */
void host_ring(void *host);
/* After the bell was exchanged: until nobody has his hand on the one before any more. */
void host_wait_for_ringers(const struct host *host);
/* What of the counters is of no bus: the host's own, then the server's. Freed by the caller. */
struct image_counter *host_plan_counters(const struct host *host, uint32_t *count);

/* host.c: 0 or a negative errno, the reason then stands in why; plan NULL: a start */
int host_make_serving(struct host *host, struct config *config, const struct adoption *plan,
                      struct serving **serving, char *why, size_t why_size);
/* All that are not running; the first that cannot be started is the error. */
int host_start_workers(struct serving *serving, char *why, size_t why_size);
int host_start_indicator(struct host *host, char *why, size_t why_size);

/*
 * host_tend.c. What a reload could not do once the engine had taken it, and what is said and
 * counted until it can; host_tend() calls it once a second.
 */
void host_mend(struct host *host);

#endif
