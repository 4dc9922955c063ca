/* SPDX-License-Identifier: MIT */
/*
 * The host: the engine's thread, the workers of its buses, and the bells that wake it. The thread
 * sleeps on them and never blocks elsewhere.
 *
 * Room src/daemon/host: what runs in it: threads, shared memory, targets, a reload.
 */
#pragma once

#include "src/daemon/engine/engine.h"
#include "src/daemon/host/memory.h"

struct host;
struct porter;

struct host_setup {
	struct config *config; /* the host owns it from here on, also if host_start() fails */
	const char *instance;
	const struct shm_dir *dir; /* stays open as long as the host */
	struct log *log;
	struct porter *porter; /* likewise */
	int rt_priority;       /* 0: ordinary scheduling */
};

/*
 * Create buses, shared memory and engine; start the threads. Returns 0, or a negative errno with
 * the reason in why.
 */
int host_start(const struct host_setup *setup, struct host **host, char *why, size_t why_size);

/* Lines of the log that consumers see: log_drain() puts them into the image. The supervisor. */
void host_show_log(struct host *host, bool on);

/* Time of the engine's last heartbeat, ns of CLOCK_BOOTTIME. Any thread. */
int64_t host_beat(const struct host *host);
/* The longest time between two heartbeats of an engine that runs. The supervisor. */
int64_t host_beats_apart(const struct host *host);
/* As serve_absent(). The supervisor. */
unsigned host_absent(struct host *host, char why[LISTEN_WHY_MAX]);
/* The configuration that is served. */
const struct config *host_config(const struct host *host);

/*
 * End in order: engine first, then the workers, at most timeout_ns each. Returns true when all
 * threads ended and everything was freed; false when a worker is stuck in the kernel: then
 * everything that others could wait for is released, and the process has to _exit().
 */
bool host_stop(struct host *host, int64_t timeout_ns);
