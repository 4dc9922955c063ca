/* SPDX-License-Identifier: MIT */
/* The bus contract: the queue of a simple bus, suspending, and what a write says. */
#include <assert.h>
#include <errno.h>
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/base/time.h"
#include "hal/bus/bus.h"

/* How often a suspended bus checks whether its target is back. */
#define LOOK_NS (3 * NS_PER_S)

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

/* Those before it move up by one, so that requests of a rank keep their order. */
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

	if (bus_req_unwanted(req))
		answer.err = -ECANCELED;
	else if (bus_now(bus->env) >= req->deadline_ns)
		answer.err = -ETIME;
	else
		bus->ops->exec(bus, req, &answer);
	bus->env->answer(bus->env->ctx, &answer);
}

void bus_report(const struct bus_env *env, enum bus_news news, int err, const char *text)
{
	struct bus_event event = {.news = (uint8_t)news, .err = err};

	snprintf(event.text, sizeof(event.text), "%s", text);
	env->event(env->ctx, &event);
}

/* Report BUS_UP for a bus without a step, which cannot be down. */
static void report_up(struct bus *bus)
{
	if (bus->told_up || bus->ops->step)
		return;
	bus->told_up = true;
	bus_report(bus->env, BUS_UP, 0, "");
}

static void refuse_all(struct bus *bus)
{
	while (bus->count) {
		struct bus_answer answer = {.id = take_request(bus, 0)->id, .err = -ENOTCONN};

		bus->env->answer(bus->env->ctx, &answer);
	}
}

/* Report once that the target of a suspended bus is visible; and again after it was gone. */
static int64_t look_for_target(struct bus *bus, int64_t now)
{
	int visible;

	if (now < bus->look_ns)
		return bus->look_ns;
	visible = bus->ops->visible ? bus->ops->visible(bus) : 1;
	if (visible == -EAGAIN)
		return now;
	if (visible > 0 && !bus->visible)
		bus_report(bus->env, BUS_BACK, 0, "");
	bus->visible = visible > 0;
	bus->look_ns = bus_now(bus->env) + LOOK_NS;
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
	bus_report(bus->env, BUS_RELEASED, 0, "");
	bus->visible = false;
	bus->look_ns = 0;
}

int bus_watch(struct bus *bus)
{
	return bus->ops->watch && !bus->suspended ? bus->ops->watch(bus) : -1;
}

const struct bus_counter *bus_counters(struct bus *bus, size_t *n)
{
	*n = 0;
	return bus->ops->counters ? bus->ops->counters(bus, n) : NULL;
}

uint32_t bus_write_text(struct bus_req *req)
{
	const int most = req->single ? FLT_DECIMAL_DIG : DBL_DECIMAL_DIG;
	char *text = (char *)req->data;
	int digits = req->single ? FLT_DIG : DBL_DIG, n;

	if (!req->number)
		return req->len;
	/* below the normal numbers fewer digits distinguish two numbers */
	if (fabs(req->value) < (req->single ? (double)FLT_MIN : DBL_MIN))
		digits = 1;
	do
		n = snprintf(text, BUS_NUMBER_TEXT, "%.*g", digits, req->value);
	while ((req->single ? strtof(text, NULL) != (float)req->value
	                    : strtod(text, NULL) != req->value) &&
	       digits++ < most);
	text[strcspn(text, ",")] = '.'; /* of a process with another decimal point */
	return (uint32_t)n;
}

int bus_write_switch(const struct bus_req *req, bool *on)
{
	static const char *const words[] = {"0", "1", "off", "on", "no", "yes"};
	const char *text = (const char *)req->data;
	uint32_t len = req->len;

	if (req->number) {
		*on = req->value == 1;
		return *on || req->value == 0 ? 0 : -EINVAL;
	}
	while (len && (text[len - 1] == '\n' || text[len - 1] == ' ' || !text[len - 1]))
		len--;
	for (; len && *text == ' '; text++)
		len--;
	for (unsigned i = 0; i < sizeof(words) / sizeof(words[0]); i++)
		if (!req->offset && strlen(words[i]) == len && !memcmp(words[i], text, len)) {
			*on = i & 1;
			return 0;
		}
	return -EINVAL;
}
