/* SPDX-License-Identifier: MIT */
/* The inside of the host, which the files of this room share. */
#pragma once

#include <pthread.h>

#include "hal/base/time.h"
#include "src/daemon/host/bells.h"
#include "src/daemon/host/serving.h"

/*
 * The supervisor's pause between two looks whether engine or server have taken what it gave them.
 */
#define HOST_LOOK_NS NS_PER_MS

struct control;
struct porter;

struct host {
	/* The engine's thread exchanges it; else only the supervisor uses it. */
	struct serving *now;
	struct serving *next; /* made by a reload, for the engine to take over */
	const struct adoption *plan;
	/* An engine with buses that have ended, for the engine's thread to abandon. */
	struct engine *ended;
	struct log *log;
	struct porter *porter;
	const char *instance;
	const struct shm_dir *dir;
	struct serve *serve; /* NULL: the owserver protocol is not served */

	struct indicator *indicator;
	pthread_t thread;
	bool running;
	bool left_behind; /* a bus is stuck in the kernel, and keeps the memory that it uses */
	bool disk_stuck;  /* a thread that stores last commands is, and may write the file yet */
	uint32_t stop;
	struct bells bells;
	struct control *control;
	int64_t image_lost_ns;
	/* What a reload has not finished. */
	bool unshown;        /* its image is not in place */
	bool unstarted;      /* its threads do not run */
	uint32_t unfinished; /* how many of the two; a counter shows it */
	int64_t finish_ns;   /* not sooner */
	struct log_rate finish_rate;
	uint32_t refused_reloads; /* since the start; a counter shows it */
};
