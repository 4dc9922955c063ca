/* SPDX-License-Identifier: MIT */
/* The bus contract: the backend of a target, the queue of a simple bus, suspending. */
#include <assert.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "hal/bus/bus.h"
#include "hal/bus/time.h"

/* How often a suspended bus checks whether its target is back. */
#define LOOK_NS (3 * NS_PER_S)

static const struct bus_ops *backend_of(const char *word, size_t len)
{
	for (const struct bus_ops *const *ops = bus_backends; *ops; ops++)
		if (strlen((*ops)->scheme) == len && memcmp((*ops)->scheme, word, len) == 0)
			return *ops;
	return NULL;
}

/* Does WORD:REST mean HOST:PORT, even with a wrong port? */
static bool is_host_and_port(const char *target, const char *colon)
{
	const char *rest = colon + 1 + strspn(colon + 1, " \t+-");
	size_t len = (size_t)(colon - target);

	return len == 0 || (*rest >= '0' && *rest <= '9') || memchr(target, '.', len) ||
	       (len == 9 && memcmp(target, "localhost", len) == 0);
}

/* Is the target an IPv6 address without its brackets? */
static bool is_bare_ipv6(const char *target, const char *colon)
{
	return strchr(colon + 1, ':') && target[strspn(target, "0123456789abcdefABCDEF:.")] == '\0';
}

/*
 * Is the word an adapter of OWFS that owsd reaches only by another target? Then why has the remedy.
 */
static bool is_others_adapter(const char *word, size_t len, char *why, size_t why_size)
{
	static const char *const usb[] = {"usb", "ds9490", "ds9490r", "ds2490"};
	static const char *const serial[] = {"serial", "link",    "linkusb",
	                                     "ds9097", "ds9097u", "ds2480b"};
	bool found = false;

	for (size_t i = 0; i < sizeof(usb) / sizeof(usb[0]) && !found; i++) {
		found = strlen(usb[i]) == len && strncasecmp(word, usb[i], len) == 0;
		if (found)
			snprintf(why, why_size,
			         "%s is a USB adapter: take target w1, which has a DS9490R "
			         "by the kernel's ds2490, or an owserver (a host: owserver:%s)",
			         usb[i], usb[i]);
	}
	for (size_t i = 0; i < sizeof(serial) / sizeof(serial[0]) && !found; i++) {
		found = strlen(serial[i]) == len && strncasecmp(word, serial[i], len) == 0;
		if (found)
			snprintf(why, why_size,
			         "%s is a serial adapter: let an owserver have it, and "
			         "name that: localhost:4304 (a host: owserver:%s)",
			         serial[i], serial[i]);
	}
	return found;
}

static int no_backend(const char *word, size_t word_len, char *why, size_t why_size)
{
	char names[160] = "";
	size_t used = 0;

	for (const struct bus_ops *const *ops = bus_backends; *ops; ops++) {
		int n = snprintf(names + used, sizeof(names) - used, " %s:", (*ops)->scheme);

		if (n < 0 || (size_t)n >= sizeof(names) - used)
			break;
		used += (size_t)n;
	}
	snprintf(why, why_size,
	         "'%.*s' is an unknown kind of target; there are%s, "
	         "and HOST, HOST:PORT, [IPv6]:PORT for an owserver",
	         (int)(word_len > 40 ? 40 : word_len), word, names);
	return -EPROTONOSUPPORT;
}

int bus_create(const char *target, const struct bus_env *env, struct bus **bus, char *why,
               size_t why_size)
{
	const char *colon = strchr(target, ':');
	size_t word_len = colon ? (size_t)(colon - target) : strlen(target);
	const struct bus_ops *ops = backend_of(target, word_len);
	const char *where = colon ? colon + 1 : "";
	int err;

	if (why_size)
		why[0] = '\0';
	if (strcmp(target, "auto") == 0) {
		snprintf(why, why_size, "auto stands for several targets: name one of them");
		return -EINVAL;
	}
	if (!ops && !(colon && is_host_and_port(target, colon)) &&
	    is_others_adapter(target, word_len, why, why_size))
		return -EINVAL;
	if (!ops) {
		if (target[0] != '[' && colon && is_bare_ipv6(target, colon)) {
			snprintf(why, why_size,
			         "an IPv6 address is written in brackets, as in [::1]:4304");
			return -EINVAL;
		}
		if (strncmp(target, "/dev/tty", 8) == 0) {
			snprintf(why, why_size,
			         "a serial adapter (DS9097U, LinkUSB): let an owserver "
			         "have it, and name that: localhost:4304");
			return -EINVAL;
		}
		if (target[0] == '/') {
			snprintf(why, why_size,
			         "a path has its way in front: i2c:/dev/i2c-1, "
			         "owserver:/SOCKET");
			return -EINVAL;
		}
		if (target[0] != '[' && colon && !is_host_and_port(target, colon))
			return no_backend(target, word_len, why, why_size);
		ops = backend_of("owserver", strlen("owserver"));
		if (!ops)
			return no_backend(target, word_len, why, why_size);
		where = target;
	}
	err = ops->create(where, env, bus, why, why_size);
	if (err == -ENOMEM)
		snprintf(why, why_size, "out of memory");
	return err;
}

int bus_init(struct bus *bus, const struct bus_ops *ops, const struct bus_env *env)
{
	assert(ops->depth >= 1 && ops->depth <= BUS_MAX_DEPTH);
	assert(!ops->exec != !(ops->submit && ops->step));
	assert(ops->exec || ops->suspend);
	*bus = (struct bus){.ops = ops, .env = env};
	if (!ops->exec)
		return 0;
	bus->queue = calloc(ops->depth, sizeof(*bus->queue));
	return bus->queue ? 0 : -ENOMEM;
}

int bus_option(struct bus *bus, const char *key, const char *text, char *why, size_t why_size)
{
	int err = -ENOENT;

	if (why_size)
		why[0] = '\0';
	if (bus->ops->option)
		err = bus->ops->option(bus, key, text, why, why_size);
	if (err == -ENOENT)
		snprintf(why, why_size, "a target of scheme %s has no option %s", bus->ops->scheme,
		         key);
	else if (err == -ENOMEM)
		snprintf(why, why_size, "out of memory");
	return err;
}

void bus_destroy(struct bus *bus)
{
	struct bus_req **queue;

	if (!bus)
		return;
	queue = bus->queue;
	bus->ops->destroy(bus);
	free(queue);
}

unsigned bus_depth(const struct bus *bus)
{
	return bus->ops->depth;
}

static struct bus_req **slot(struct bus *bus, unsigned i)
{
	return &bus->queue[(bus->head + i) % bus->ops->depth];
}

static struct bus_req *take_request(struct bus *bus, unsigned i)
{
	struct bus_req *req = *slot(bus, i);

	for (; i > 0; i--)
		*slot(bus, i) = *slot(bus, i - 1);
	bus->head = (bus->head + 1) % bus->ops->depth;
	bus->count--;
	return req;
}

static unsigned most_urgent(struct bus *bus)
{
	unsigned best = 0;

	for (unsigned i = 1; i < bus->count; i++)
		if ((*slot(bus, i))->prio < (*slot(bus, best))->prio)
			best = i;
	return best;
}

int bus_submit(struct bus *bus, struct bus_req *req)
{
	if (bus->ops->submit)
		return bus->ops->submit(bus, req);
	if (bus->count == bus->ops->depth)
		return -EAGAIN;
	*slot(bus, bus->count++) = req;
	return 0;
}

static void exec_next(struct bus *bus)
{
	struct bus_req *req = take_request(bus, most_urgent(bus));
	struct bus_answer answer = {.id = req->id};

	if (bus->env->now(bus->env->ctx) >= req->deadline_ns)
		answer.err = -ETIME;
	else
		bus->ops->exec(bus, req, &answer);
	bus->env->answer(bus->env->ctx, &answer);
}

static void report_news(struct bus *bus, enum bus_news news)
{
	const struct bus_event event = {.news = (uint8_t)news};

	bus->env->event(bus->env->ctx, &event);
}

/* Report BUS_UP for a bus without a step, which cannot be down. */
static void report_up(struct bus *bus)
{
	if (bus->told_up || bus->ops->step)
		return;
	bus->told_up = true;
	report_news(bus, BUS_UP);
}

static void refuse_all(struct bus *bus)
{
	while (bus->count) {
		struct bus_answer answer = {.id = take_request(bus, 0)->id, .err = -ENOTCONN};

		bus->env->answer(bus->env->ctx, &answer);
	}
}

static int64_t look_for_target(struct bus *bus, int64_t now)
{
	int there;

	if (now < bus->look_ns)
		return bus->look_ns;
	there = bus->ops->there ? bus->ops->there(bus) : 1;
	if (there == -EAGAIN)
		return now;
	if (there > 0 && !bus->there)
		report_news(bus, BUS_BACK);
	bus->there = there > 0;
	bus->look_ns = bus->env->now(bus->env->ctx) + LOOK_NS;
	return bus->look_ns;
}

static int64_t step_suspended(struct bus *bus, int64_t now)
{
	if (bus->ops->exec)
		refuse_all(bus);
	else
		bus->ops->step(bus, now);
	return look_for_target(bus, now);
}

int64_t bus_step(struct bus *bus, int64_t now)
{
	int64_t next = INT64_MAX;

	if (bus->suspended)
		return step_suspended(bus, now);
	if (!bus->ops->exec)
		return bus->ops->step(bus, now);
	report_up(bus);
	if (bus->ops->step)
		next = bus->ops->step(bus, now);
	if (bus->count == 0)
		return next;
	exec_next(bus);
	return bus->count || bus->ops->step ? now : INT64_MAX;
}

void bus_suspend(struct bus *bus, bool yes)
{
	if (bus->suspended == yes)
		return;
	bus->suspended = yes;
	if (bus->ops->suspend)
		bus->ops->suspend(bus, yes);
	bus->told_up = false;
	if (!yes)
		return;
	if (bus->ops->exec)
		refuse_all(bus);
	report_news(bus, BUS_RELEASED);
	bus->there = false;
	bus->look_ns = 0;
}

const struct bus_counter *bus_counters(struct bus *bus, size_t *n)
{
	*n = 0;
	return bus->ops->counters ? bus->ops->counters(bus, n) : NULL;
}
