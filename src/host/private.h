/* SPDX-License-Identifier: MIT */
/* The inside of the host, which the files of this room share. */
#ifndef HOST_PRIVATE_H
#define HOST_PRIVATE_H

#include <pthread.h>

#include "hal/bus/time.h"
#include "src/host/serving.h"

/*
 * The supervisor's pause between two looks whether engine or server have taken what it gave them.
 */
#define HOST_LOOK_NS NS_PER_MS

struct host {
	/* The engine's thread exchanges it; else only the supervisor uses it. */
	struct serving *now;
	struct serving *next; /* made by a reload, for the engine to take over */
	const struct adoption *plan;
	/* An engine whose buses have ended, for the engine's thread to abandon. */
	struct engine *ended;
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
	/* What a reload has not finished. */
	bool unshown;        /* its image is not in place */
	bool unstarted;      /* its threads do not run */
	uint32_t unfinished; /* how many of the two; a counter shows it */
	int64_t finish_ns;   /* not sooner */
	struct log_rate finish_rate;
	uint64_t idle_rings, mended;
};

#endif
