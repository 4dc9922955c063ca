/* SPDX-License-Identifier: MIT */
/*
 * Opens a target without an engine, and sends requests to it. The caller's thread steps the bus. A
 * target that has missed its deadline is dead and never stepped again: the bus could write an
 * answer to memory that the caller has freed.
 */
#include <errno.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "hal/bus/tap.h"
#include "src/faces/show/json.h"
#include "src/ground/signal/error.h"
#include "src/tool/scan/target.h"

#define GRACE_NS (2 * NS_PER_S) /* after its deadline the bus has this time to end a request */

static int64_t boottime(void *ctx)
{
	(void)ctx;
	return clock_ns(CLOCK_BOOTTIME);
}

static int wait_fd(void *ctx, int fd, short events, int64_t until_ns)
{
	struct pollfd poll_fd = {.fd = fd, .events = events};
	int64_t left;

	while ((left = until_ns - boottime(ctx)) > 0) {
		struct timespec t = timespec_of(left);

		if (ppoll(&poll_fd, 1, &t, NULL) > 0)
			return 1;
	}
	return ppoll(&poll_fd, 1, &(struct timespec){0}, NULL) > 0;
}

static void take_answer(void *ctx, const struct bus_answer *answer)
{
	struct target *target = ctx;
	uint32_t i = answer->id - target->first_id;
	const struct bus_env *env = target->bus->env;

	if (i >= target->count)
		return;
	if (env->tap)
		env->tap->answered(env->tap, env, &target->asks[i].req, answer);
	target->asks[i].answer = *answer;
	target->answered++;
}

static void take_event(void *ctx, const struct bus_event *event)
{
	struct target *target = ctx;

	switch ((enum bus_news)event->news) {
	case BUS_UP:
		target->up = true;
		break;
	case BUS_DOWN:
		target->down = true;
		target->loss = *event;
		break;
	case BUS_NOTE:
		if (target->note && target->bus->ops->testing)
			target->note(event->text);
		break;
	case BUS_TROUBLE:
		if (target->note && *event->text)
			target->note(event->text);
		break;
	case BUS_FOUND:
	case BUS_LOST:
	case BUS_POR:
	case BUS_RELEASED:
	case BUS_BACK:
		break;
	}
}

/* Step the bus, and sleep until it wants more, but not past until_ns. */
static void target_step(struct target *target, int64_t until_ns)
{
	unsigned answered = target->answered;
	bool known = target->up || target->down;
	int64_t next = bus_step(target->bus, boottime(NULL));

	/* an answer or an event came: return to the caller, which may wait for it */
	if (target->answered != answered || known != (target->up || target->down))
		return;
	if (next > until_ns)
		next = until_ns;
	if (next > boottime(NULL))
		wait_fd(NULL, -1, 0, next);
}

static int64_t deadline(const struct target *target)
{
	int64_t until_ns = boottime(NULL) + target->timeout_ns;

	return target->until_ns && until_ns > target->until_ns ? target->until_ns : until_ns;
}

static int connect_once(struct target *target, char *why, size_t why_size)
{
	int64_t until_ns = deadline(target);
	int err;

	target->env = (struct bus_env){.ctx = target,
	                               .now = boottime,
	                               .wait = wait_fd,
	                               .answer = take_answer,
	                               .event = take_event,
	                               .tap = target->tap};
	target->up = target->down = false;
	why[0] = '\0';
	err = target->create(target->name, &target->env, &target->bus, why, why_size);
	if (err) {
		if (!why[0])
			snprintf(why, why_size, "%s", strerror(-err));
		return err;
	}
	while (!target->up && !target->down && boottime(NULL) < until_ns)
		target_step(target, until_ns);
	if (target->up)
		return 0;
	snprintf(why, why_size, "cannot open %s: %s", target->name,
	         target->down ? target->loss.text : "no answer in time");
	target_close(target);
	return -ENOTCONN;
}

int target_connect(struct target *target, char *why, size_t why_size)
{
	int64_t left_ns = target->until_ns ? target->until_ns - boottime(NULL) : 0;
	int64_t again_ns = boottime(NULL) + left_ns / 4 * 3;
	int err;

	do
		err = connect_once(target, why, why_size);
	while (err == -ENOTCONN && boottime(NULL) < again_ns && usleep(200 * 1000) == 0);
	return err;
}

void target_close(struct target *target)
{
	bus_destroy(target->bus);
	target->bus = NULL;
}

void target_ask(struct target *target, struct ask *asks, unsigned count)
{
	unsigned given = 0;
	int64_t until = deadline(target) + GRACE_NS;

	target->printed_ns = boottime(NULL);
	target->first_id += target->count;
	target->asks = asks;
	target->count = count;
	target->answered = 0;
	for (unsigned i = 0; i < count; i++)
		asks[i].answer = (struct bus_answer){.err = -ETIMEDOUT};
	while (!target->dead && target->answered < count && boottime(NULL) < until) {
		unsigned answered = target->answered;

		while (given < count) {
			struct bus_req *req = &asks[given].req;

			req->id = target->first_id + given;
			req->deadline_ns = deadline(target);
			if (bus_submit(target->bus, req))
				break;
			given++;
		}
		target_step(target, until);
		if (target->progress && count > 1)
			target->progress(target);
		if (target->answered != answered)
			until = deadline(target) + GRACE_NS;
	}
	target->dead = target->answered < count;
}

int target_ask_one(struct target *target, struct ask *ask)
{
	target_ask(target, ask, 1);
	return ask->answer.err;
}

const char *target_error(const struct target *target, int err)
{
	bool lost = target->down && (err == -ECONNRESET || err == -ENOTCONN);

	return lost && *target->loss.text ? target->loss.text : error_text(err);
}

bool target_path(const char *given, char path[256], bool *fresh)
{
	static const char word[] = "/uncached";
	size_t len = sizeof(word) - 1;
	int n = snprintf(path, 256, "%s%s", *given == '/' ? "" : "/", given);

	if (n < 0 || n >= 256)
		return false;
	*fresh = strncmp(path, word, len) == 0 && (!path[len] || path[len] == '/');
	if (*fresh)
		memmove(path, path + len, strlen(path + len) + 1);
	if (!*path)
		snprintf(path, 256, "/");
	return true;
}

#define PADDED 12

static size_t blanks(const char *text, size_t len)
{
	size_t n = 0;

	while (n < len && text[n] == ' ')
		n++;
	return n;
}

size_t target_unpad(char *text, size_t len)
{
	size_t out = 0;

	for (size_t at = 0, n; at <= len; at += n + 1) {
		const char *comma = memchr(text + at, ',', len - at);
		size_t lead = blanks(text + at, len - at);

		n = comma ? (size_t)(comma - text) - at : len - at;
		if (lead > n || (lead && n != PADDED) ||
		    !json_is_number(text + at + lead, n - lead))
			return len;
	}
	for (size_t at = 0; at < len; at++)
		if (text[at] != ' ')
			text[out++] = text[at];
	return out;
}
