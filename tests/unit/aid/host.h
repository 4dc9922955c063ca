/* SPDX-License-Identifier: MIT */
/*
 * The host of a bus under test. On the virtual clock a wait takes no time: it moves the clock. On
 * the real one it waits as a worker does. Either way answers and events are collected here.
 */
#pragma once

#include "hal/bus/bus.h"

#define HOST_ROOM 1024
#define HOST_MS INT64_C(1000000)
#define HOST_S INT64_C(1000000000)

struct host {
	struct bus_env env;
	int64_t now;   /* of the virtual clock */
	bool shutdown; /* waits return -ECANCELED */
	/* Virtual clock: when fd becomes ready; INT64_MAX never. Called before a wait on fd. */
	int64_t (*ready)(void *ctx, int fd, short events);
	void *ready_ctx;
	unsigned answers, events, waits;
	struct bus_answer answer[HOST_ROOM];
	struct bus_event event[HOST_ROOM];
};

void host_init_virtual(struct host *host);
void host_init_real(struct host *host);
int64_t host_now(struct host *host);
/* Create the bus of target; fails the test when that fails. */
struct bus *host_bus(struct host *host, const char *target);
/* Step the bus until `until` (virtual: the clock jumps from step to step). */
void host_run(struct host *host, struct bus *bus, int64_t until_ns);
/* Step until there are n answers or `until` has come. Returns whether there are n. */
bool host_run_answers(struct host *host, struct bus *bus, unsigned n, int64_t until_ns);
bool host_run_events(struct host *host, struct bus *bus, unsigned n, int64_t until_ns);
/* The first answer to id, or NULL; and the number of answers to id. */
const struct bus_answer *host_answer(const struct host *host, uint32_t id);
unsigned host_answers(const struct host *host, uint32_t id);
unsigned host_events(const struct host *host, enum bus_news news);
