/* SPDX-License-Identifier: MIT */
/* The host of a fuzzed bus, which checks the bus contract. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "hal/bus/backends.h"
#include "tests/fuzz/bus_host.h"

/* A bus works at most so often without that time passes. */
#define SPINS 100000

static int64_t now(void *ctx)
{
	return ((struct bus_host *)ctx)->now;
}

static int wait_for(void *ctx, int fd, short events, int64_t until_ns)
{
	struct bus_host *host = ctx;
	int64_t ready = fd >= 0 && host->ready ? host->ready(host->ctx, fd, events) : INT64_MAX;

	if (host->shutdown)
		return -ECANCELED;
	TEST_ASSERT_MESSAGE(until_ns < INT64_MAX || ready < INT64_MAX, "a wait without deadline");
	if (host->steps)
		host->steps--;
	if (ready < until_ns) {
		if (ready > host->now)
			host->now = ready;
		return 1;
	}
	if (until_ns > host->now)
		host->now = until_ns;
	return 0;
}

static bool is_listed(int err)
{
#define ERROR(name) -name,
	static const int listed[] = {0, BUS_ERRORS(ERROR)};
#undef ERROR

	for (size_t i = 0; i < sizeof(listed) / sizeof(listed[0]); i++)
		if (err == listed[i])
			return true;
	return false;
}

static void check_listing(const uint8_t *data, uint32_t len)
{
	TEST_ASSERT_TRUE_MESSAGE(!len || data[len - 1] == '\n', "the last path has no end");
	for (uint32_t i = 0; i < len; i++)
		TEST_ASSERT_TRUE_MESSAGE(data[i], "a listing has a NUL");
}

static void take_answer(void *ctx, const struct bus_answer *answer)
{
	struct bus_host *host = ctx;
	unsigned at = answer->id % BUS_HOST_REQS;
	struct bus_req *req = &host->slot[at].req;

	TEST_ASSERT_TRUE_MESSAGE(host->slot[at].lent && req->id == answer->id,
	                         "an answer to nothing");
	TEST_ASSERT_TRUE_MESSAGE(is_listed(answer->err), "no error of hal/bus/bus.h");
	TEST_ASSERT_TRUE_MESSAGE(answer->len <= req->len, "longer than its room");
	if (answer->err)
		TEST_ASSERT_EQUAL_UINT32(0, answer->len);
	else if (req->op == BUS_DIR)
		check_listing(req->data, answer->len);
	host->down_owed |= answer->err == -ETIMEDOUT || answer->err == -ECONNRESET ||
	                   answer->err == -EPROTO;
	host->slot[at].lent = false;
	host->lent--;
	host->answered++;
	host->good += answer->err == 0;
	free(req->data);
	req->data = NULL;
}

static void take_event(void *ctx, const struct bus_event *event)
{
	struct bus_host *host = ctx;

	TEST_ASSERT_TRUE(memchr(event->text, '\0', sizeof(event->text)) != NULL);
	TEST_ASSERT_TRUE(event->news <= BUS_BACK);
	if (event->news == BUS_UP)
		TEST_ASSERT_FALSE_MESSAGE(host->down_owed, "up again, and its loss was not told");
	if (event->news == BUS_DOWN || event->news == BUS_RELEASED)
		host->down_owed = false;
}

void bus_host_begin(struct bus_host *host)
{
	*host = (struct bus_host){.now = 1000 * BUS_HOST_S, .steps = SPINS};
	host->env = (struct bus_env){.ctx = host,
	                             .now = now,
	                             .wait = wait_for,
	                             .answer = take_answer,
	                             .event = take_event};
}

struct bus *bus_host_open(struct bus_host *host, const char *target)
{
	char why[300] = "";
	int err = bus_create(target, &host->env, &host->bus, why, sizeof(why));

	TEST_ASSERT_TRUE_MESSAGE(!err || why[0] || err == -ENOMEM, "no reason is given");
	if (err)
		host->bus = NULL;
	return host->bus;
}

void bus_host_end(struct bus_host *host)
{
	bus_destroy(host->bus);
	for (unsigned i = 0; i < BUS_HOST_REQS; i++)
		if (host->slot[i].lent)
			free(host->slot[i].req.data);
}

void bus_host_ask(struct bus_host *host, enum bus_op op, const char *path, bool fresh,
                  const void *data, uint32_t len, int64_t timeout_ns)
{
	unsigned at = host->next_id % BUS_HOST_REQS;
	struct bus_req *req = &host->slot[at].req;

	if (host->slot[at].lent)
		return;
	*req = (struct bus_req){.id = host->next_id,
	                        .op = (uint8_t)op,
	                        .prio = BUS_GUEST,
	                        .fresh = fresh,
	                        .deadline_ns = host->now + timeout_ns,
	                        .len = len};
	TEST_ASSERT_TRUE(strlen(path) < sizeof(host->slot[at].path));
	strcpy(host->slot[at].path, path);
	req->path = host->slot[at].path;
	req->data = malloc(len ? len : 1);
	TEST_ASSERT_NOT_NULL(req->data);
	if (data && len)
		memcpy(req->data, data, len);
	if (bus_submit(host->bus, req)) {
		free(req->data);
		return;
	}
	host->next_id++;
	host->slot[at].lent = true;
	host->lent++;
}

void bus_host_run(struct bus_host *host, int64_t ns, bool until_answered)
{
	int64_t end = host->now + ns;

	host->steps = SPINS;
	while (host->now < end && (host->lent || !until_answered) && !host->shutdown) {
		int64_t next = bus_step(host->bus, host->now);

		TEST_ASSERT_TRUE_MESSAGE(host->steps--, "the bus spins");
		if (next > end)
			next = end;
		if (next > host->now) {
			host->now = next;
			host->steps = SPINS;
		}
	}
}
