/* SPDX-License-Identifier: MIT */
/* The host of a bus under test, on a virtual or the real clock. */
#include <errno.h>
#include <poll.h>
#include <string.h>
#include <time.h>

#include "unity.h"

#include "hal/bus/backends.h"
#include "tests/unit/aid/host.h"

static int64_t boottime(void)
{
	struct timespec t;

	clock_gettime(CLOCK_BOOTTIME, &t);
	return (int64_t)t.tv_sec * HOST_S + t.tv_nsec;
}

static int64_t virtual_now(void *ctx)
{
	return ((struct host *)ctx)->now;
}

static int64_t real_now(void *ctx)
{
	(void)ctx;
	return boottime();
}

static int virtual_wait(void *ctx, int fd, short events, int64_t until_ns)
{
	struct host *host = ctx;
	int64_t ready = INT64_MAX;

	host->waits++;
	if (host->shutdown)
		return -ECANCELED;
	if (fd >= 0 && host->ready)
		ready = host->ready(host->ready_ctx, fd, events);
	TEST_ASSERT_MESSAGE(until_ns < INT64_MAX || ready < INT64_MAX, "a wait without deadline");
	if (ready < until_ns) {
		if (ready > host->now)
			host->now = ready;
		return 1;
	}
	if (until_ns > host->now)
		host->now = until_ns;
	return 0;
}

static int real_wait(void *ctx, int fd, short events, int64_t until_ns)
{
	struct host *host = ctx;
	struct pollfd poll_fd = {.fd = fd, .events = events};

	host->waits++;
	for (;;) {
		int64_t left = until_ns - boottime();
		struct timespec t = {.tv_sec = (time_t)(left / HOST_S),
		                     .tv_nsec = (long)(left % HOST_S)};

		if (host->shutdown)
			return -ECANCELED;
		if (left < 0)
			t = (struct timespec){0};
		if (ppoll(&poll_fd, 1, &t, NULL) > 0)
			return 1;
		if (boottime() >= until_ns)
			return 0;
	}
}

static void take_answer(void *ctx, const struct bus_answer *answer)
{
	struct host *host = ctx;

	TEST_ASSERT_LESS_THAN_UINT_MESSAGE(HOST_ROOM, host->answers, "too many answers");
	host->answer[host->answers++] = *answer;
}

static void take_event(void *ctx, const struct bus_event *event)
{
	struct host *host = ctx;

	TEST_ASSERT_LESS_THAN_UINT_MESSAGE(HOST_ROOM, host->events, "too many events");
	host->event[host->events++] = *event;
}

void host_init_virtual(struct host *host)
{
	*host = (struct host){.now = 1000 * HOST_S};
	host->env = (struct bus_env){.ctx = host,
	                             .now = virtual_now,
	                             .wait = virtual_wait,
	                             .answer = take_answer,
	                             .event = take_event};
}

void host_init_real(struct host *host)
{
	host_init_virtual(host);
	host->env.now = real_now;
	host->env.wait = real_wait;
}

int64_t host_now(struct host *host)
{
	return host->env.now(host);
}

struct bus *host_bus(struct host *host, const char *target)
{
	struct bus *bus = NULL;
	char why[200] = "";
	int err = bus_create(target, &host->env, &bus, why, sizeof(why));

	TEST_ASSERT_EQUAL_INT_MESSAGE(0, err, why);
	TEST_ASSERT_NOT_NULL(bus);
	return bus;
}

static void run(struct host *host, struct bus *bus, unsigned answers, unsigned events,
                int64_t until_ns)
{
	while (host->answers < answers && host->events < events) {
		int64_t now = host_now(host);
		int64_t next;

		if (now >= until_ns)
			return;
		next = bus_step(bus, now);
		if (host->answers >= answers || host->events >= events)
			return;
		if (next > until_ns)
			next = until_ns;
		if (next > host_now(host))
			bus->stirred = host->env.wait(host, bus_watch(bus), POLLIN, next) > 0;
	}
}

void host_run(struct host *host, struct bus *bus, int64_t until_ns)
{
	run(host, bus, HOST_ROOM + 1, HOST_ROOM + 1, until_ns);
}

bool host_run_answers(struct host *host, struct bus *bus, unsigned n, int64_t until_ns)
{
	run(host, bus, n, HOST_ROOM + 1, until_ns);
	return host->answers >= n;
}

bool host_run_events(struct host *host, struct bus *bus, unsigned n, int64_t until_ns)
{
	run(host, bus, HOST_ROOM + 1, n, until_ns);
	return host->events >= n;
}

const struct bus_answer *host_answer(const struct host *host, uint32_t id)
{
	for (unsigned i = 0; i < host->answers; i++)
		if (host->answer[i].id == id)
			return &host->answer[i];
	return NULL;
}

unsigned host_answers(const struct host *host, uint32_t id)
{
	unsigned n = 0;

	for (unsigned i = 0; i < host->answers; i++)
		n += host->answer[i].id == id;
	return n;
}

unsigned host_events(const struct host *host, enum bus_news news)
{
	unsigned n = 0;

	for (unsigned i = 0; i < host->events; i++)
		n += host->event[i].news == news;
	return n;
}
