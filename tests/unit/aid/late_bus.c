/* SPDX-License-Identifier: MIT */
/*
 * The late bus: the test double of the overlapping tier. With it no test comes to rely on answers
 * that are prompt, in order, single and certain. Its devices are those of the null bus. Target:
 * `late:` and options, joined by ';': seed, late (longest delay in milliseconds), twice and never
 * (percent of the requests), up and down (milliseconds that the target is there and away).
 * A path below /never, /twice or /late (a second) is treated so whatever the options are.
 *
 * It is in the table of backends of all programs that are linked with this file, and so is sim.
 */
#include <assert.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/base/time.h"
#include "hal/bus/bus.h"
#include "hal/sim/bus.h"

static const struct bus_ops late_bus;

#define LATE_DEPTH 16
#define LATE_ECHOES 64
#define LATE_BY_NAME (1000 * NS_PER_MS)

enum late_option { SEED, LATE, TWICE, NEVER, UP, DOWN, OPTIONS };

static const struct {
	const char *name;
	uint32_t fallback, most;
} options[OPTIONS] = {
	[SEED] = {"seed", 1, UINT32_MAX}, [LATE] = {"late", 50, 60000},
	[TWICE] = {"twice", 0, 100},      [NEVER] = {"never", 0, 100},
	[UP] = {"up", 0, 3600000},        [DOWN] = {"down", 1000, 3600000},
};

struct late_slot {
	struct bus_req *req;
	int64_t due_ns;
	bool twice, never;
};

/* A second answer, for a request that the bus has already answered. */
struct late_echo {
	struct bus_answer answer;
	int64_t due_ns;
};

struct late_bus {
	struct bus bus;
	struct bus *table;
	uint32_t option[OPTIONS];
	uint32_t random;
	bool up, is_told;
	int64_t turn_ns; /* when the target goes or comes */
	struct late_slot slot[LATE_DEPTH];
	struct late_echo echo[LATE_ECHOES];
};

static uint32_t draw(struct late_bus *late, uint32_t below)
{
	late->random ^= late->random << 13;
	late->random ^= late->random >> 17;
	late->random ^= late->random << 5;
	return late->random % below;
}

static int set_option(struct late_bus *late, const char *text, size_t len)
{
	const char *equals = memchr(text, '=', len);
	char *end = NULL;

	for (int i = 0; equals && i < OPTIONS; i++) {
		unsigned long long value;
		size_t name_len = (size_t)(equals - text);

		if (strlen(options[i].name) != name_len ||
		    memcmp(options[i].name, text, name_len) != 0)
			continue;
		if (equals[1] < '0' || equals[1] > '9')
			return -EINVAL;
		value = strtoull(equals + 1, &end, 10);
		if (end != text + len || value > options[i].most)
			return -EINVAL;
		late->option[i] = (uint32_t)value;
		return 0;
	}
	return -EINVAL;
}

static int set_options(struct late_bus *late, const char *where, char *why, size_t why_size)
{
	for (int i = 0; i < OPTIONS; i++)
		late->option[i] = options[i].fallback;
	while (*where) {
		size_t len = strcspn(where, ";");

		if (set_option(late, where, len)) {
			snprintf(why, why_size,
			         "'late:': '%.*s' is not an option; there are seed, late, twice, "
			         "never, up, down, each with =NUMBER",
			         (int)(len > 40 ? 40 : len), where);
			return -EINVAL;
		}
		where += len + (where[len] == ';');
	}
	late->random = late->option[SEED] ? late->option[SEED] : 1;
	return 0;
}

static void late_destroy(struct bus *bus)
{
	struct late_bus *late = (struct late_bus *)bus;

	bus_destroy(late->table);
	free(late);
}

static int late_create(const char *where, const struct bus_env *env, struct bus **bus, char *why,
                       size_t why_size)
{
	struct late_bus *late = calloc(1, sizeof(*late));
	int err;

	if (!late)
		return -ENOMEM;
	err = bus_init(&late->bus, &late_bus, env);
	if (!err)
		err = set_options(late, where, why, why_size);
	if (!err)
		err = null_bus.create("", env, &late->table, why, why_size);
	if (err) {
		free(late);
		return err;
	}
	*bus = &late->bus;
	return 0;
}

static bool is_below(const struct bus_req *req, const char *name)
{
	size_t len = strlen(name);

	return strncmp(req->path, name, len) == 0 && (req->path[len] == '/' || !req->path[len]);
}

static int late_submit(struct bus *bus, struct bus_req *req)
{
	struct late_bus *late = (struct late_bus *)bus;
	struct late_slot *slot = late->slot;
	int64_t delay = (int64_t)draw(late, late->option[LATE] + 1) * NS_PER_MS;

	while (slot < late->slot + LATE_DEPTH && slot->req)
		slot++;
	if (slot == late->slot + LATE_DEPTH)
		return -EAGAIN;
	slot->req = req;
	slot->never = is_below(req, "/never") || draw(late, 100) < late->option[NEVER];
	slot->twice = is_below(req, "/twice") || draw(late, 100) < late->option[TWICE];
	if (is_below(req, "/late"))
		delay = LATE_BY_NAME;
	slot->due_ns = bus->env->now(bus->env->ctx) + delay;
	return 0;
}

static void give_again(struct late_bus *late, const struct bus_answer *answer, int64_t now)
{
	for (unsigned i = 0; i < LATE_ECHOES; i++) {
		if (late->echo[i].due_ns)
			continue;
		late->echo[i].answer = *answer;
		late->echo[i].due_ns = now + 1 +
		                       (int64_t)draw(late, late->option[LATE] + 1) * NS_PER_MS;
		return;
	}
}

static void give(struct late_bus *late, struct late_slot *slot, int64_t now)
{
	const struct bus_env *env = late->bus.env;
	struct bus_req real = *slot->req;
	struct bus_answer answer = {.id = real.id};

	if (is_below(&real, "/twice"))
		real.path += strlen("/twice");
	else if (is_below(&real, "/late"))
		real.path += strlen("/late");
	if (!late->up || late->bus.suspended)
		answer.err = -ENOTCONN;
	else if (now >= real.deadline_ns)
		answer.err = -ETIME;
	else
		late->table->ops->exec(late->table, &real, &answer);
	slot->req = NULL;
	env->answer(env->ctx, &answer);
	if (slot->twice)
		give_again(late, &answer, now);
}

static void turn(struct late_bus *late, int64_t now)
{
	late->up = !late->up;
	late->is_told = false;
	late->turn_ns = INT64_MAX;
	if (late->option[UP])
		late->turn_ns = now + (int64_t)late->option[late->up ? UP : DOWN] * NS_PER_MS;
}

static void report_turn(struct late_bus *late)
{
	struct bus_event event = {.news = late->up ? BUS_UP : BUS_DOWN,
	                          .err = late->up ? 0 : -ECONNRESET};

	late->is_told = true;
	snprintf(event.text, sizeof(event.text), "late: the target %s",
	         late->up ? "is there" : "went away");
	late->bus.env->event(late->bus.env->ctx, &event);
}

static int64_t late_step(struct bus *bus, int64_t now)
{
	struct late_bus *late = (struct late_bus *)bus;
	int64_t next;

	if (now >= late->turn_ns)
		turn(late, now);
	if (!late->is_told && !bus->suspended)
		report_turn(late);
	next = late->turn_ns;
	for (unsigned i = 0; i < LATE_DEPTH; i++) {
		struct late_slot *slot = &late->slot[i];

		if (!slot->req || slot->never)
			continue;
		if (now >= slot->due_ns)
			give(late, slot, now);
		else if (slot->due_ns < next)
			next = slot->due_ns;
	}
	for (unsigned i = 0; i < LATE_ECHOES; i++) {
		struct late_echo *echo = &late->echo[i];

		if (echo->due_ns && now >= echo->due_ns) {
			echo->due_ns = 0;
			bus->env->answer(bus->env->ctx, &echo->answer);
		} else if (echo->due_ns && echo->due_ns < next) {
			next = echo->due_ns;
		}
	}
	return next;
}

/* Answer all requests now, but for those that are never answered. */
static void late_suspend(struct bus *bus, bool yes)
{
	struct late_bus *late = (struct late_bus *)bus;

	late->is_told = false;
	for (unsigned i = 0; yes && i < LATE_DEPTH; i++)
		if (late->slot[i].req && !late->slot[i].never)
			give(late, &late->slot[i], bus->env->now(bus->env->ctx));
}

static int late_there(struct bus *bus)
{
	return ((struct late_bus *)bus)->up;
}

static const struct bus_ops late_bus = {
	.scheme = "late",
	.summary = "the null bus with answers late, out of order, twice and never",
	.testing = true,
	.depth = LATE_DEPTH,
	.create = late_create,
	.destroy = late_destroy,
	.submit = late_submit,
	.step = late_step,
	.suspend = late_suspend,
	.visible = late_there,
};

const struct bus_ops *const bus_backends[] = {
#define BACKEND(name, automatic) &name##_bus,
#include "hal/bus/schemes.h"
#undef BACKEND
	&sim_bus,
	&late_bus,
	NULL,
};
